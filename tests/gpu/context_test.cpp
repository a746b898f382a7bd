// Contexts: version, conventions, error reporting, and timers that tell the truth.
#include <chrono>

#include <gmock/gmock.h>

#include "core/error.h"
#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "gl/timer.h"
#include "gl_fixture.h"

namespace matchlight {
namespace {

class Context : public GlTest {};

TEST_F(Context, is_4_5_core_and_says_what_it_is) {
    const GlInfo& info = context().info();
    EXPECT_GE(info.major * 10 + info.minor, 45);
    EXPECT_FALSE(info.vendor.empty());
    EXPECT_FALSE(info.renderer.empty());
    EXPECT_FALSE(info.platform.empty());
    EXPECT_GE(info.max_samples, 4);           // OpenGL 4.5, table 23.53
    EXPECT_GE(info.max_texture_size, 16384);  // OpenGL 4.5, table 23.53
    EXPECT_EQ(current_gl_context(), &context());
}

TEST_F(Context, an_error_is_reported_once_with_where_it_happened) {
    glEnable(0xdead);
    try {
        check_no_gl_error("enabling nonsense");
        FAIL() << "the error went unnoticed";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("enabling nonsense"));
    }
    EXPECT_NO_THROW(check_no_gl_error("afterwards"));
}

TEST_F(Context, a_second_context_can_be_made_and_left) {
    {
        const auto other = create_offscreen_context();
        EXPECT_EQ(current_gl_context(), other.get());
    }
    EXPECT_EQ(current_gl_context(), nullptr);
    context().make_current();
    const Buffer buffer(16);
    EXPECT_TRUE(glIsBuffer(buffer.name()));
}

TEST_F(Context, row_0_is_the_top_and_depth_is_reversed) {
    const Texture2D color({.format = GL_RGBA32F, .width = 4, .height = 2});
    const Texture2D depth({.format = GL_DEPTH_COMPONENT32F, .width = 4, .height = 2});
    const Framebuffer framebuffer({color}, depth);
    ShaderLibrary shaders(MATCHLIGHT_SOURCE_DIR "/tests/gpu/shaders");
    Program& program = shaders.program({{GL_VERTEX_SHADER, "depth.vert"}, {GL_FRAGMENT_SHADER, "position.frag"}});
    framebuffer.clear_color(0, 0, 0, 0, 0);
    framebuffer.clear_depth();
    framebuffer.bind();
    program.use();
    glEnable(GL_DEPTH_TEST);
    const FullScreenTriangle triangle;
    program.set("depth", 0.75F);  // near, drawn first
    program.set("mark", 1.0F);
    triangle.draw();
    program.set("depth", 0.25F);  // far, must lose
    program.set("mark", 2.0F);
    triangle.draw();
    glDisable(GL_DEPTH_TEST);
    const ImageF seen = framebuffer.read<float>(framebuffer.bounds(), 4);
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) {
            EXPECT_FLOAT_EQ(seen.at(x, y, 0), (static_cast<float>(x) + 0.5F) / 4);  // uv counts from the top left
            EXPECT_FLOAT_EQ(seen.at(x, y, 1), (static_cast<float>(y) + 0.5F) / 2);
            EXPECT_FLOAT_EQ(seen.at(x, y, 2), static_cast<float>(y) + 0.5F);  // so does gl_FragCoord
            EXPECT_FLOAT_EQ(seen.at(x, y, 3), 1);                             // the near one stays
        }
    }
    EXPECT_FLOAT_EQ(depth.read<float>({0, 0, 1, 1}, 1).at(0, 0), 0.75F);
}

TEST_F(Context, the_timer_agrees_with_the_clock) {
    // Work of about 50 ms on a software rasteriser, less on a GPU; what the timer says lies within what the wall clock
    // around it says, and covers most of it.
    const Texture2D target({.format = GL_RGBA32F, .width = 1024, .height = 1024});
    const Framebuffer framebuffer({target});
    GpuTimer timer;
    ShaderLibrary shaders(MATCHLIGHT_SOURCE_DIR "/tests/gpu/shaders");
    Program& program = shaders.program({{GL_VERTEX_SHADER, "depth.vert"}, {GL_FRAGMENT_SHADER, "busy.frag"}});
    program.use();
    framebuffer.bind();
    const FullScreenTriangle triangle;
    triangle.draw();  // compiles the variant
    glFinish();
    const auto started = std::chrono::steady_clock::now();
    timer.start();
    for (int i = 0; i < 8; ++i) triangle.draw();
    const double measured_ms = timer.stop();
    const double wall_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
    EXPECT_LE(measured_ms, wall_ms);
    EXPECT_GT(measured_ms, 0.5 * wall_ms);
}

}  // namespace
}  // namespace matchlight
