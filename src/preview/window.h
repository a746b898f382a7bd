// The window: its size, its title, and the keys pressed in it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "gl/window_context.h"
#include "preview/keys.h"
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
    /// Shows it fitted to picture and screen.
    void show_fitted(const PictureSize& picture);

    /// Lets events in; waits for one for at most so long.
    void wait(double seconds);
    /// What keys asked for since the last call, in order; closing the window is to quit.
    std::vector<PreviewAction> take_actions();
    /// Whether what was in it is gone or of another size.
    bool take_damage();

    /// In pixels; 0 × 0 while it is minimised.
    Eigen::Vector2i framebuffer_size() const;
    void set_title(const std::string& title);
    void swap();

private:
    void listen();

    std::unique_ptr<WindowContext> context_;
    std::vector<PreviewAction> actions_;
    std::string title_;
    bool damaged_ = true;
};

}  // namespace matchlight
