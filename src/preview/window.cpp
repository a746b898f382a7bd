// GLFW's callbacks collect what happened; nothing is done inside them.
#include "preview/window.h"

#include <algorithm>
#include <cstdlib>
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

/// Of a Unicode code point (RFC 3629).
std::string utf8_of(unsigned character) {
    const auto tail = [&](int shift) { return static_cast<char>(0x80 | ((character >> shift) & 0x3f)); };
    const auto head = [&](unsigned mark, int shift) { return static_cast<char>(mark | (character >> shift)); };
    if (character < 0x80) return {static_cast<char>(character)};
    if (character < 0x800) return {head(0xc0, 6), tail(0)};
    if (character < 0x10000) return {head(0xe0, 12), tail(6), tail(0)};
    return {head(0xf0, 18), tail(12), tail(6), tail(0)};
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
                         "run it on a desktop, or under xvfb-run (Debian: xvfb); matchlight render needs none");
    }
    listen();
}

void PreviewWindow::listen() {
    GLFWwindow* window = context_->window();
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int scancode, int event, int modifiers) {
        // What the key types, where letters have other places than on an American keyboard.
        const char* typed = glfwGetKeyName(key, scancode);
        // Super is the desktop's own.
        if ((modifiers & GLFW_MOD_SUPER) != 0 && event != GLFW_RELEASE) return;
        window_of(of).add({.kind = InputEvent::Kind::key,
                           .code = key,
                           .down = event != GLFW_RELEASE,
                           .repeated = event == GLFW_REPEAT,
                           .control = (modifiers & GLFW_MOD_CONTROL) != 0,
                           .shift = (modifiers & GLFW_MOD_SHIFT) != 0,
                           .alt = (modifiers & GLFW_MOD_ALT) != 0,
                           .text = typed != nullptr ? typed : ""});
    });
    glfwSetCharCallback(window, [](GLFWwindow* of, unsigned character) {
        window_of(of).add({.kind = InputEvent::Kind::text, .text = utf8_of(character)});
    });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* of) { window_of(of).add({.kind = InputEvent::Kind::close}); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* of) { window_of(of).damaged_ = true; });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* of, int, int) { window_of(of).damaged_ = true; });
    listen_to_pointer();
}

void PreviewWindow::listen_to_pointer() {
    GLFWwindow* window = context_->window();
    glfwSetCursorPosCallback(window, [](GLFWwindow* of, double x, double y) {
        window_of(of).add({.kind = InputEvent::Kind::pointer, .value = window_of(of).pixels_of(x, y)});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* of, int button, int event, int modifiers) {
        window_of(of).add({.kind = InputEvent::Kind::button,
                           .code = button,
                           .down = event == GLFW_PRESS,
                           .control = (modifiers & GLFW_MOD_CONTROL) != 0,
                           .shift = (modifiers & GLFW_MOD_SHIFT) != 0,
                           .alt = (modifiers & GLFW_MOD_ALT) != 0});
    });
    glfwSetScrollCallback(window, [](GLFWwindow* of, double x, double y) {
        window_of(of).add({.kind = InputEvent::Kind::scroll, .value = {x, y}});
    });
    glfwSetDropCallback(window, [](GLFWwindow* of, int count, const char** paths) {
        for (int i = 0; i < count; ++i) {
            window_of(of).add({.kind = InputEvent::Kind::drop, .text = paths[i]});
        }
    });
}

Eigen::Vector2d PreviewWindow::pixels_of(double x, double y) const {
    Eigen::Vector2i screen(1, 1);
    glfwGetWindowSize(context_->window(), &screen.x(), &screen.y());
    const Eigen::Vector2d pixels = framebuffer_size().cast<double>();
    return {x * pixels.x() / std::max(1, screen.x()), y * pixels.y() / std::max(1, screen.y())};
}

float PreviewWindow::content_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(context_->window(), &x, &y);
    return std::clamp(std::max(x, y), 0.5f, 4.0f);
}

void PreviewWindow::wake() {
    glfwPostEmptyEvent();
}

void PreviewWindow::show(const Eigen::Vector2i& size) {
    glfwSetWindowSize(context_->window(), size.x(), size.y());
    glfwShowWindow(context_->window());
}

void PreviewWindow::show_fitted(const PictureSize& content) {
    // A tenth of the screen is for the window's frame and the desktop's bars that the work area does not tell of.
    constexpr double share_of_screen = 0.9;
    const Eigen::Vector2i least(320, 240);
    Eigen::Vector2i place(0, 0), screen = least;
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
        glfwGetMonitorWorkarea(monitor, &place.x(), &place.y(), &screen.x(), &screen.y());
    }
    show(fitted_window(content, (screen.cast<double>() * share_of_screen).cast<int>(), least));
}

void PreviewWindow::wait(double seconds) {
    if (seconds > 0) {
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwPollEvents();
    }
}

std::vector<InputEvent> PreviewWindow::take_events() {
    return std::exchange(events_, {});
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
