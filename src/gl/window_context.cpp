// GLFW is started for the window and ended with it.
#include "gl/window_context.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "core/error.h"

namespace matchlight {

namespace {

std::string glfw_error(const char* otherwise) {
    const char* description = nullptr;
    glfwGetError(&description);
    return description != nullptr ? description : otherwise;
}

}  // namespace

std::unique_ptr<WindowContext> WindowContext::create(const std::string& title, const std::string& platform,
                                                     std::string& failure) {
    if (!glfwInit()) {
        failure = glfw_error("no display");
        return nullptr;
    }
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, required_gl_major);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, required_gl_minor);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, want_gl_debug_context ? GLFW_TRUE : GLFW_FALSE);
    constexpr int small_px = 16;  // whoever shows it gives it its size
    GLFWwindow* window = glfwCreateWindow(small_px, small_px, title.c_str(), nullptr, nullptr);
    if (window == nullptr) {
        failure = glfw_error("no window");
        glfwTerminate();
        return nullptr;
    }
    std::unique_ptr<WindowContext> result(new WindowContext(window));
    try {
        result->make_current();
        result->set_up(platform);
    } catch (const InputError& error) {
        failure = error.what();
        return nullptr;
    }
    return result;
}

WindowContext::~WindowContext() {
    note_destroyed();
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void WindowContext::make_current() {
    glfwMakeContextCurrent(window_);
    note_current();
}

}  // namespace matchlight
