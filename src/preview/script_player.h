// Plays a script into the window, one thing a frame, so that it goes the same way every time.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "preview/controls.h"
#include "preview/input_event.h"
#include "preview/script.h"
#include "preview/script_clock.h"

namespace matchlight {

/// What scripts do other than by hand.
struct ScriptStage {
    std::function<bool()> idle;
    std::function<void(const std::string& panel)> show;  // throws std::invalid_argument where there is none
    std::function<void(std::int64_t frame)> go_to;
    std::function<void(const std::filesystem::path&)> screenshot;
    std::function<std::int64_t()> pictures;  // that were drawn so far
    std::function<bool()> is_busy;           // with what takes so long that the window tells it
    std::function<void(const std::string&)> print;
    std::function<void()> quit;
};

class ScriptPlayer {
public:
    /// Throws InputError.
    ScriptPlayer(std::filesystem::path path, ScriptStage stage);

    /// What happens before the next frame is laid out. Throws InputError naming file and line.
    std::vector<InputEvent> before_frame(Controls& controls);
    /// Whether what was set found its control. Throws InputError naming file and line.
    void after_frame(Controls& controls);
    /// For what is drawn; nothing is done meanwhile.
    bool waits() const { return waiting_; }
    bool finished() const { return next_ == steps_.size() && ticks_.empty(); }

private:
    using Tick = std::vector<InputEvent>;
    void begin(const ScriptStep& step, Controls& controls);
    void click(const ScriptStep& step, const Controls& controls);
    void drag(const ScriptStep& step);
    void slide(const ScriptStep& step, const Controls& controls);
    void drag(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double step_count, const InputEvent& button);
    [[noreturn]] void fail(const std::string& cause) const;

    std::filesystem::path path_;
    ScriptStage stage_;
    std::vector<ScriptStep> steps_;
    std::size_t next_ = 0;
    std::deque<Tick> ticks_;
    bool waiting_ = false;
    bool waits_for_work_ = false;
    int still_frames_ = 0;
    int patience_ = 0;  // frames that a control may still take to appear
    ScriptClock clock_;
};

}  // namespace matchlight
