// OpenGL 4.5 core contexts; off screen from EGL surfaceless, an EGL device, or a hidden GLFW window.
//
// Conventions that every context here is set up with:
// - row 0 of a texture or framebuffer is the top of the picture (clip control, upper left), as in core/image.h: nothing
//   is flipped on upload or readback, and clip-space y still points up;
// - clip-space depth is 0..1 and reversed: near 1, far 0; depth tests pass on GL_GREATER;
// - pixel rows are packed without padding; cube maps filter across their edges; no sRGB conversion on write.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace matchlight {

inline constexpr int required_gl_major = 4;
inline constexpr int required_gl_minor = 5;
#ifdef NDEBUG
inline constexpr bool want_gl_debug_context = false;
#else
inline constexpr bool want_gl_debug_context = true;
#endif

/// What the driver says of itself.
struct GlInfo {
    std::string platform;  // "EGL surfaceless", "EGL device", "GLFW hidden window" or "GLFW window"
    std::string vendor, renderer, version, shading_language;
    int major = 0, minor = 0;
    bool is_software = false;  // a rasteriser on the CPU, by the renderer's name
    int max_samples = 0;       // of float colour targets and depth together
    int max_texture_size = 0;
    int max_cube_size = 0;
    int max_array_layers = 0;
    std::int64_t max_storage_block_bytes = 0;
};

/// One context. It belongs to the thread that made it current last; destroying it frees whatever is left in it.
class GlContext {
public:
    virtual ~GlContext() = default;
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    virtual void make_current() = 0;

    const GlInfo& info() const { return info_; }

    /// Whether GL_TIME_ELAPSED agrees with the wall clock: never on software rasterisers, elsewhere measured once, when
    /// first asked, by some milliseconds of work.
    bool timer_queries_are_reliable();

protected:
    GlContext() = default;
    /// Once, after the context became current for the first time: fills `info_`, sets the conventions, listens for
    /// errors. Throws InputError when the version is below 4.5.
    void set_up(const std::string& platform);
    void note_current();
    void note_destroyed();

private:
    friend void check_no_gl_error(const std::string& where);
    friend GlContext* current_gl_context();

    GlInfo info_;
    std::vector<std::string> errors_;  // reported by KHR_debug since the last check
    std::optional<bool> reliable_timers_;
};

/// An off-screen context, current on return. Throws InputError naming what was found when there is no OpenGL 4.5.
std::unique_ptr<GlContext> create_offscreen_context();

/// The context that is current on this thread through make_current, or null.
GlContext* current_gl_context();

/// Throws InputError when GL reported an error since the last check; `where` says what was being done.
void check_no_gl_error(const std::string& where);

}  // namespace matchlight
