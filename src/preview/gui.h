// Dear ImGui's context: its look, its fonts, and what a hand does to it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "preview/gui_damage.h"
#include "preview/gui_renderer.h"
#include "preview/input_event.h"

struct ImGuiContext;

namespace matchlight {

class Gui {
public:
    /// `scale`: pixels of the screen for one of an ordinary screen's.
    explicit Gui(float scale);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void feed(const InputEvent& event);
    /// Controls may be laid out from here to `end`.
    void begin(const Eigen::Vector2i& size_px, double seconds);
    /// Returns where they look otherwise than before: parts of the window that do not overlap.
    std::vector<Region> end();
    /// What was laid out of that part.
    void draw(const Framebuffer& target, const Region& part);

    /// Whether keys go into a text field.
    bool wants_text() const;

    Eigen::Vector2d pointer_px() const;

    float scale() const { return scale_; }

private:
    void set_look();
    void load_font();

    float scale_;
    ImGuiContext* context_;
    GuiRenderer renderer_;
    GuiDamage damage_;
};

}  // namespace matchlight
