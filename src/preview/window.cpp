// GLFW's callbacks collect what happened; nothing is done inside them.
#include "preview/window.h"

#include <cstdlib>
#include <string_view>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace {

PreviewWindow& window_of(GLFWwindow* window) {
    return *static_cast<PreviewWindow*>(glfwGetWindowUserPointer(window));
}

bool is_pressed(const PreviewKey& key, int glfw_key, int scancode) {
    if (key.glfw_key != 0) return key.glfw_key == glfw_key;
    // What the key types, where letters have other places than on an American keyboard.
    const char* typed = glfwGetKeyName(glfw_key, scancode);
    return typed != nullptr && key.name == std::string_view(typed);
}

}  // namespace

PreviewWindow::PreviewWindow() {
    std::string failure;
    context_ = WindowContext::create("matchlight preview", "GLFW window", failure);
    if (!context_) {
        const char* display = std::getenv("DISPLAY");
        throw InputError({},
                         fmt::format("no window with OpenGL {}.{} could be opened (GLFW, DISPLAY is {}): {}",
                                     required_gl_major, required_gl_minor,
                                     display != nullptr ? fmt::format("'{}'", printable(display)) : "not set", failure),
                         "run it on a desktop, or under xvfb-run (Debian: xvfb)");
    }
    listen();
}

void PreviewWindow::listen() {
    GLFWwindow* window = context_->window();
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* of, int glfw_key, int scancode, int event, int modifiers) {
        constexpr int held = GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER;  // the desktop's own
        if (event == GLFW_RELEASE || (modifiers & held) != 0) return;
        for (const PreviewKey& key : preview_keys()) {
            if (!is_pressed(key, glfw_key, scancode) || (event == GLFW_REPEAT && !key.repeats)) continue;
            window_of(of).actions_.push_back(key.action);
            return;
        }
    });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* of) { window_of(of).actions_.push_back(PreviewAction::quit); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* of) { window_of(of).damaged_ = true; });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* of, int, int) { window_of(of).damaged_ = true; });
}

void PreviewWindow::show(const Eigen::Vector2i& size) {
    glfwSetWindowSize(context_->window(), size.x(), size.y());
    glfwShowWindow(context_->window());
}

void PreviewWindow::show_fitted(const PictureSize& picture) {
    // A tenth of the screen is for the window's frame and the desktop's bars that the work area does not tell of.
    constexpr double share_of_screen = 0.9;
    const Eigen::Vector2i least(320, 240);
    Eigen::Vector2i place(0, 0), screen = least;
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
        glfwGetMonitorWorkarea(monitor, &place.x(), &place.y(), &screen.x(), &screen.y());
    }
    show(fitted_window(picture, (screen.cast<double>() * share_of_screen).cast<int>(), least));
}

void PreviewWindow::wait(double seconds) {
    if (seconds > 0) {
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwPollEvents();
    }
}

std::vector<PreviewAction> PreviewWindow::take_actions() {
    return std::exchange(actions_, {});
}

bool PreviewWindow::take_damage() {
    return std::exchange(damaged_, false);
}

Eigen::Vector2i PreviewWindow::framebuffer_size() const {
    Eigen::Vector2i size(0, 0);
    glfwGetFramebufferSize(context_->window(), &size.x(), &size.y());
    return size;
}

void PreviewWindow::set_title(const std::string& title) {
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(context_->window(), title_.c_str());
}

void PreviewWindow::swap() {
    glfwSwapBuffers(context_->window());
}

}  // namespace matchlight
