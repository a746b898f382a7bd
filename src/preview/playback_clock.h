// What time of the clip it is while it plays.
#pragma once

#include <chrono>

namespace matchlight {

class PlaybackClock {
public:
    using Clock = std::chrono::steady_clock;

    void start(double time_s, Clock::time_point now) {
        start_time_s_ = time_s;
        started_ = now;
    }
    double time_s(Clock::time_point now) const {
        return start_time_s_ + std::chrono::duration<double>(now - started_).count();
    }

private:
    double start_time_s_ = 0;
    Clock::time_point started_;
};

}  // namespace matchlight
