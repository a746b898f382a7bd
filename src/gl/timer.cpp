// Timer queries, and the test of whether they mean anything.
#include "gl/timer.h"

#include <cassert>

#include "core/elapsed.h"
#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/program.h"

namespace matchlight {

namespace {

using Clock = std::chrono::steady_clock;

GlName<gl_detail::delete_query> make_query() {
    GLuint name = 0;
    glCreateQueries(GL_TIME_ELAPSED, 1, &name);
    return GlName<gl_detail::delete_query>(name);
}

double query_ms(GLuint query) {
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    return static_cast<double>(nanoseconds) * 1e-6;
}

}  // namespace

GpuTimer::GpuTimer() {
    GlContext* context = current_gl_context();
    assert(context);
    if (context->timer_queries_are_reliable()) query_ = make_query();
}

void GpuTimer::start() {
    if (query_) {
        glBeginQuery(GL_TIME_ELAPSED, query_.get());
        return;
    }
    glFinish();
    started_ = Clock::now();
}

double GpuTimer::stop() {
    if (query_) {
        glEndQuery(GL_TIME_ELAPSED);
        return query_ms(query_.get());
    }
    glFinish();
    return milliseconds_since(started_);
}

bool timer_queries_agree_with_the_clock() {
    // Clears of a texture, doubled until they take long enough for the overhead of the calls not to matter; several
    // times, because numbers without meaning may look right once.
    const Texture2D target({.format = GL_RGBA32F, .width = 1024, .height = 1024});
    const Framebuffer framebuffer({target});
    const auto query = make_query();
    constexpr int trials = 3;
    constexpr double long_enough_ms = 4;
    constexpr int most_clears = 1 << 14;
    int clears = 1;
    for (int trial = 0; trial < trials; ++trial) {
        double clock_ms = 0;
        double timer_ms = 0;
        while (true) {
            glFinish();
            const auto start = Clock::now();
            glBeginQuery(GL_TIME_ELAPSED, query.get());
            for (int i = 0; i < clears; ++i) framebuffer.clear_color(0, static_cast<float>(i), 0, 0, 1);
            glEndQuery(GL_TIME_ELAPSED);
            glFinish();
            clock_ms = milliseconds_since(start);
            timer_ms = query_ms(query.get());
            if (clock_ms >= long_enough_ms || clears >= most_clears) break;
            clears *= 2;
        }
        // The work is the same; a query that covers less than half or more than all of it (with a little slack for its
        // own granularity) measures something else.
        if (timer_ms < 0.5 * clock_ms || timer_ms > 1.1 * clock_ms) return false;
    }
    return true;
}

}  // namespace matchlight
