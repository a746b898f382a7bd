// The window: its size, its title, and what a hand does to it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gl/window_context.h"
#include "preview/input_event.h"
#include "preview/letterbox.h"

namespace matchlight {

class PreviewWindow {
public:
    /// Hidden at first; its context is current. Throws InputError where there is no display, or no OpenGL 4.5 on it.
    PreviewWindow();
    PreviewWindow(const PreviewWindow&) = delete;
    PreviewWindow& operator=(const PreviewWindow&) = delete;

    GlContext& context() { return *context_; }

    /// Shows it, of this size.
    void show(const Eigen::Vector2i& size);
    /// Shows it fitted to what is to be seen in it, and to the screen.
    void show_fitted(const PictureSize& content);

    /// Lets events in; waits for one for at most so long.
    void wait(double seconds);
    /// What was done to it since the last call, in order.
    std::vector<InputEvent> take_events();
    /// Whether what was in it is gone or of another size.
    bool take_damage();

    /// In pixels; 0 × 0 while it is minimised.
    Eigen::Vector2i framebuffer_size() const;
    /// Pixels of this screen for one of an ordinary screen's.
    float content_scale() const;
    void set_title(const std::string& title);
    void swap();
    /// Ends `wait`; may be called by any thread.
    static void wake();

private:
    void listen();
    void listen_to_pointer();
    void add(InputEvent event) { events_.push_back(std::move(event)); }
    /// GLFW tells places in screen coordinates.
    Eigen::Vector2d pixels_of(double x, double y) const;

    std::unique_ptr<WindowContext> context_;
    std::vector<InputEvent> events_;
    std::string title_;
    bool damaged_ = true;
};

}  // namespace matchlight
