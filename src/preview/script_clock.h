// How soon pictures follow what a scripted hand does, and how many a second while it moves.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace matchlight {

/// Of the last thing that was done; before the first, of the program since it was started.
class ScriptClock {
public:
    using Clock = std::chrono::steady_clock;

    ScriptClock();

    /// Something is done; so many pictures were drawn before.
    void begin(std::int64_t pictures);
    /// The hand moves still.
    void move() { moved_ = Clock::now(); }
    /// So many pictures are drawn by now.
    void count(std::int64_t pictures);
    /// All that came of it is there.
    void settle() { settled_ = Clock::now(); }

    /// In a line: times, pictures, and what memory and processor time the program has taken since it was started.
    std::string told() const;

private:
    Clock::time_point began_, moved_, settled_;
    std::vector<Clock::time_point> pictures_;
    std::int64_t counted_ = 0;
    double processor_before_s_ = 0;
};

}  // namespace matchlight
