// Opens a context on the first platform that has OpenGL 4.5 core and sets the conventions of context.h.
#include "gl/context.h"

#include <cassert>
#include <cstdlib>

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include "core/error.h"
#include "gl/timer.h"
#include "gl/window_context.h"

namespace matchlight {

namespace {

thread_local GlContext* current_context = nullptr;

std::string gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "";
}

int gl_integer(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

bool names_a_software_rasteriser(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader", "Software"}) {
        if (renderer.find(name) != std::string::npos) return true;
    }
    return false;
}

class EglContext final : public GlContext {
public:
    /// Null when the display gives no such context; `failure` then says why.
    static std::unique_ptr<EglContext> create(EGLDisplay display, const std::string& platform, std::string& failure);
    ~EglContext() override {
        note_destroyed();
        if (context_ != EGL_NO_CONTEXT) {
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            eglDestroyContext(display_, context_);
        }
        // The display stays initialised: it is shared by every context of the process.
    }
    void make_current() override {
        if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
            throw InputError({}, fmt::format("EGL error {:#x} while making the OpenGL context current", eglGetError()));
        }
        note_current();
    }

private:
    EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}

    EGLDisplay display_;
    EGLContext context_;
};

/// The version of the best context the display gives, for the message that says it is too old.
std::string describe_any_context(EGLDisplay display) {
    const EGLint attributes[] = {EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) return "no desktop OpenGL";
    std::string text = "an OpenGL context that cannot be used without a surface";
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        text = fmt::format("OpenGL {} ({})", gl_string(GL_VERSION), gl_string(GL_RENDERER));
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(display, context);
    return text;
}

std::unique_ptr<EglContext> EglContext::create(EGLDisplay display, const std::string& platform, std::string& failure) {
    EGLint major = 0;
    EGLint minor = 0;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) {
        failure = "no display";
        return nullptr;
    }
    if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") ||
        !epoxy_has_egl_extension(display, "EGL_KHR_create_context") || !eglBindAPI(EGL_OPENGL_API)) {
        failure = fmt::format("EGL {}.{} without surfaceless desktop OpenGL", major, minor);
        return nullptr;
    }
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 required_gl_major,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 required_gl_minor,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 want_gl_debug_context ? EGL_TRUE : EGL_FALSE,
                                 EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) {
        failure = describe_any_context(display);
        return nullptr;
    }
    std::unique_ptr<EglContext> result(new EglContext(display, context));
    try {
        result->make_current();
        result->set_up(platform);
    } catch (const InputError& error) {
        failure = error.what();
        return nullptr;
    }
    return result;
}

std::unique_ptr<GlContext> create_surfaceless(std::string& failure) {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        failure = "not offered by EGL";
        return nullptr;
    }
    // The EXT entry point: libepoxy aborts on the core one while no display is known.
    const EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    return EglContext::create(display, "EGL surfaceless", failure);
}

std::unique_ptr<GlContext> create_on_device(std::string& failure) {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
        !(epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
          epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))) {
        failure = "not offered by EGL";
        return nullptr;
    }
    EGLint count = 0;
    if (!eglQueryDevicesEXT(0, nullptr, &count) || count == 0) {
        failure = "no device";
        return nullptr;
    }
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    eglQueryDevicesEXT(count, devices.data(), &count);
    for (const EGLDeviceEXT device : devices) {
        const EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
        if (auto context = EglContext::create(display, "EGL device", failure)) return context;
    }
    return nullptr;
}

void APIENTRY collect_error(GLenum source, GLenum type, GLuint, GLenum severity, GLsizei length, const GLchar* message,
                            const void* user) {
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;  // compiling and linking throw by themselves
    if (type != GL_DEBUG_TYPE_ERROR && severity != GL_DEBUG_SEVERITY_HIGH) return;
    auto& errors = *static_cast<std::vector<std::string>*>(const_cast<void*>(user));
    // A loop that fails would otherwise fill the memory before anybody checks.
    constexpr std::size_t most_kept = 16;
    if (errors.size() >= most_kept) return;
    errors.emplace_back(length < 0 ? std::string(message) : std::string(message, static_cast<std::size_t>(length)));
}

}  // namespace

void GlContext::note_current() {
    current_context = this;
}

void GlContext::note_destroyed() {
    if (current_context == this) current_context = nullptr;
}

void GlContext::set_up(const std::string& platform) {
    info_.platform = platform;
    info_.vendor = gl_string(GL_VENDOR);
    info_.renderer = gl_string(GL_RENDERER);
    info_.version = gl_string(GL_VERSION);
    info_.major = gl_integer(GL_MAJOR_VERSION);
    info_.minor = gl_integer(GL_MINOR_VERSION);
    if (info_.major < required_gl_major || (info_.major == required_gl_major && info_.minor < required_gl_minor)) {
        throw InputError({}, fmt::format("OpenGL {} ({})", info_.version, info_.renderer));
    }
    info_.shading_language = gl_string(GL_SHADING_LANGUAGE_VERSION);
    info_.is_software = names_a_software_rasteriser(info_.renderer);
    info_.max_samples = gl_integer(GL_MAX_SAMPLES);
    for (const GLenum limit : {GL_MAX_COLOR_TEXTURE_SAMPLES, GL_MAX_DEPTH_TEXTURE_SAMPLES}) {
        info_.max_samples = std::min(info_.max_samples, gl_integer(limit));
    }
    info_.max_texture_size = gl_integer(GL_MAX_TEXTURE_SIZE);
    info_.max_cube_size = gl_integer(GL_MAX_CUBE_MAP_TEXTURE_SIZE);
    info_.max_array_layers = gl_integer(GL_MAX_ARRAY_TEXTURE_LAYERS);
    GLint64 block = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
    info_.max_storage_block_bytes = block;

    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);  // so that an error belongs to the call that made it
    glDebugMessageCallback(collect_error, &errors_);

    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glDepthFunc(GL_GREATER);
    glClearDepth(0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_DITHER);
    check_no_gl_error("setting up the context");
}

bool GlContext::timer_queries_are_reliable() {
    assert(current_context == this);
    // A rasteriser on the CPU works when it is flushed, not when it is called: right numbers there are luck.
    if (!reliable_timers_) reliable_timers_ = !info_.is_software && timer_queries_agree_with_the_clock();
    return *reliable_timers_;
}

std::unique_ptr<GlContext> create_offscreen_context() {
    std::string surfaceless = "no EGL library";
    std::string device = surfaceless;
    std::string window;
    if (epoxy_has_egl()) {
        if (auto context = create_surfaceless(surfaceless)) return context;
        if (auto context = create_on_device(device)) return context;
    }
    if (auto context = WindowContext::create("matchlight", "GLFW hidden window", window)) return context;
    throw InputError({},
                     fmt::format("no OpenGL {}.{} core context: EGL surfaceless: {}; EGL device: {}; hidden window: {}",
                                 required_gl_major, required_gl_minor, surfaceless, device, window),
                     "install a driver (Debian: libgl1-mesa-dri libegl1) or run on a machine that has one");
}

GlContext* current_gl_context() {
    return current_context;
}

void check_no_gl_error(const std::string& where) {
    std::string found;
    if (current_context && !current_context->errors_.empty()) {
        found = current_context->errors_.front();
        current_context->errors_.clear();
    }
    // KHR_debug may be silent outside of debug contexts; the flags never are. A lost context reports one for ever.
    constexpr int most_flags = 8;
    for (int i = 0; i < most_flags; ++i) {
        const GLenum error = glGetError();
        if (error == GL_NO_ERROR) break;
        if (found.empty()) found = fmt::format("error {:#06x}", error);
    }
    if (!found.empty()) throw InputError({}, fmt::format("OpenGL, {}: {}", where, found));
}

}  // namespace matchlight
