// Round robin.
#include "report/run_time.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <numeric>

#include "core/elapsed.h"
#include "core/error.h"
#include "core/stop.h"
#include "gl/timer.h"

namespace matchlight {
namespace {

double timed_ms(const std::function<void()>& work, Stopwatch stopwatch) {
    if (stopwatch == Stopwatch::gpu) {
        GpuTimer timer;
        timer.start();
        work();
        return timer.stop();
    }
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    work();
    glFinish();
    return milliseconds_since(start);
}

}  // namespace

std::vector<RunTime> time_in_turn(std::span<const std::function<void()>> works, Stopwatch stopwatch,
                                  const TimingOptions& options) {
    constexpr std::size_t enough = 3;
    std::vector<std::vector<double>> samples(works.size());
    for (const auto& work : works) {
        if (work && options.warm_up) work();
    }
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        for (std::size_t i = 0; i < works.size(); ++i) {
            if (!works[i]) continue;
            if (stop_requested()) throw InputError("", "stopped by a signal");
            const double spent_ms = std::accumulate(samples[i].begin(), samples[i].end(), 0.0);
            if (samples[i].size() >= enough && spent_ms > options.most_seconds * 1e3) continue;
            samples[i].push_back(timed_ms(works[i], stopwatch));
        }
    }
    std::vector<RunTime> times;
    for (std::vector<double>& one : samples) times.push_back(one.empty() ? RunTime{} : run_time_of(std::move(one)));
    return times;
}

}  // namespace matchlight
