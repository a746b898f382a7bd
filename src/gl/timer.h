// Times GPU work: timer queries where they can be trusted, the wall clock between two glFinish elsewhere.
#pragma once

#include <chrono>

#include "gl/objects.h"

namespace matchlight {

/// A stopwatch around drawing calls. Not nestable (GL_TIME_ELAPSED is not).
class GpuTimer {
public:
    /// Needs a current GlContext, which says whether its queries can be trusted.
    GpuTimer();

    void start();
    /// Milliseconds since start(); waits for the work to end.
    double stop();

private:
    GlName<gl_detail::delete_query> query_;  // empty: wall clock
    std::chrono::steady_clock::time_point started_;
};

/// The self-test behind GlContext::timer_queries_are_reliable: times one draw both ways.
bool timer_queries_agree_with_the_clock();

}  // namespace matchlight
