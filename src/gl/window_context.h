// A context in a window of GLFW's: shown to the user, or hidden where nothing else gives a context.
#pragma once

#include <memory>
#include <string>

#include "gl/context.h"

struct GLFWwindow;

namespace matchlight {

/// One at a time: GLFW ends with it. Row 0 of what is drawn into the window itself is at its bottom, whatever the
/// conventions of context.h: pictures are drawn into a framebuffer object and copied over upside down.
class WindowContext final : public GlContext {
public:
    /// A hidden window with a context, current on return; null when there is no display or no OpenGL 4.5: `failure`
    /// then says why.
    static std::unique_ptr<WindowContext> create(const std::string& title, const std::string& platform,
                                                 std::string& failure);
    ~WindowContext() override;
    void make_current() override;

    GLFWwindow* window() const { return window_; }

private:
    explicit WindowContext(GLFWwindow* window) : window_(window) {}

    GLFWwindow* window_;
};

}  // namespace matchlight
