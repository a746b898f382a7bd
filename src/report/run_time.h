// Times several ways to do one thing against each other.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "report/report.h"

namespace matchlight {

enum class Stopwatch {
    gpu,  // drawing alone: timer queries where they can be trusted
    wall  // all of it, on both sides of the bus
};

struct TimingOptions {
    int repeats = 7;
    /// A way that has taken this long in all is run no more, after three times.
    double most_seconds = 20;
    bool warm_up = true;  // each is run once untimed
};

/// Runs each once untimed (programs compile) unless told not to, then all of them in turn, so that what else the
/// machine does hits all alike. Empty ones take no time. Needs a current context.
std::vector<RunTime> time_in_turn(std::span<const std::function<void()>> works, Stopwatch stopwatch,
                                  const TimingOptions& options);

}  // namespace matchlight
