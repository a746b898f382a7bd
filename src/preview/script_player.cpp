// Presses and releases take a frame each, as ImGui wants to see them.
#include "preview/script_player.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "preview/keys.h"

namespace matchlight {

namespace {

using Kind = InputEvent::Kind;

/// A control that another one brings up is there a frame or two later.
constexpr int most_patience = 4;

constexpr double usual_steps = 8;  // of a drag

InputEvent pointer_at(double x, double y) {
    return {.kind = Kind::pointer, .value = {x, y}};
}

/// The left button unless a word says otherwise: "right", "middle", or "shift" for the left one with that key.
InputEvent button_of(const ScriptStep& step, std::size_t word) {
    InputEvent event{.kind = Kind::button, .code = 0, .down = true};
    if (step.words.size() <= word || step.words[word] == "left") return event;
    event.shift = step.words[word] == "shift";
    if (event.shift) return event;
    event.code = step.words[word] == "right" ? 1 : 2;
    if (event.code == 1 || step.words[word] == "middle") return event;
    throw std::invalid_argument(fmt::format("'{}' is no button: left, right, middle or shift", step.words[word]));
}

/// Throws std::invalid_argument where nothing of it is seen.
Region seen_part(const Controls& controls, const std::string& name) {
    const LaidOutControl* control = controls.find(name);
    if (control == nullptr) throw std::invalid_argument(fmt::format("no control '{}' is shown", name));
    if (control->seen.empty()) throw std::invalid_argument(fmt::format("the control '{}' is out of sight", name));
    return control->seen;
}

Eigen::Vector2d middle_of(const Region& part) {
    return {part.x + part.width / 2.0, part.y + part.height / 2.0};
}

InputEvent let_go(InputEvent button) {
    button.down = button.shift = false;
    return button;
}

}  // namespace

ScriptPlayer::ScriptPlayer(std::filesystem::path path, ScriptStage stage)
    : path_(std::move(path)), stage_(std::move(stage)), steps_(read_script(path_)) {}

void ScriptPlayer::fail(const std::string& cause) const {
    const std::int64_t line = next_ > 0 ? steps_[next_ - 1].line : 0;
    throw InputError({.file = path_, .frame = {}, .cause = cause, .cure = {}, .line = line});
}

void ScriptPlayer::click(const ScriptStep& step, const Controls& controls) {
    Eigen::Vector2d at(0, 0);
    if (step.numbers.empty()) {
        at = middle_of(seen_part(controls, step.words[0]));
    } else {
        at = {step.numbers[0], step.numbers[1]};
    }
    const InputEvent button = button_of(step, step.numbers.empty() ? 1 : 2);
    ticks_ = {{pointer_at(at.x(), at.y())}, {button}, {let_go(button)}, {}};
}

void ScriptPlayer::drag(const ScriptStep& step) {
    const bool has_steps = step.numbers.size() > 4;
    const InputEvent button = button_of(step, has_steps ? 5 : 4);
    const Eigen::Vector2d from(step.numbers[0], step.numbers[1]), to(step.numbers[2], step.numbers[3]);
    drag(from, to, has_steps ? step.numbers[4] : usual_steps, button);
}

void ScriptPlayer::slide(const ScriptStep& step, const Controls& controls) {
    const Region seen = seen_part(controls, step.words[0]);
    const Eigen::Vector2d from = middle_of(seen), to(seen.x + step.numbers[0] * seen.width, from.y());
    drag(from, to, step.numbers.size() > 1 ? step.numbers[1] : usual_steps, {.kind = Kind::button, .down = true});
}

void ScriptPlayer::drag(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double step_count,
                        const InputEvent& button) {
    const int steps = std::max(1, static_cast<int>(std::lround(step_count)));
    ticks_ = {{pointer_at(from.x(), from.y())}, {button}};
    for (int i = 1; i <= steps; ++i) {
        const Eigen::Vector2d at = from + (to - from) * (static_cast<double>(i) / steps);
        ticks_.push_back({pointer_at(at.x(), at.y())});
    }
    ticks_.push_back({let_go(button)});
    ticks_.push_back({});
}

void ScriptPlayer::begin(const ScriptStep& step, Controls& controls) {
    const std::string& verb = step.verb;
    if (!verb.starts_with("wait") && verb != "measure") clock_.begin(stage_.pictures());
    if (verb == "wait_idle") {
        waiting_ = true;
        still_frames_ = 0;
    } else if (verb == "wait_busy") {
        waits_for_work_ = true;
    } else if (verb == "key") {
        InputEvent down = event_of_key(step.words[0]), up = down;
        up.down = up.control = up.shift = false;
        ticks_ = {{down}, {up}};
    } else if (verb == "click") {
        click(step, controls);
    } else if (verb == "drag") {
        drag(step);
    } else if (verb == "slide") {
        slide(step, controls);
    } else if (verb == "move") {
        ticks_ = {{pointer_at(step.numbers[0], step.numbers[1])}, {}};
    } else if (verb == "scroll") {
        ticks_ = {{pointer_at(step.numbers[0], step.numbers[1])},
                  {{.kind = Kind::scroll, .value = {0, step.numbers[2]}}},
                  {}};
    } else if (verb == "drop") {
        ticks_ = {{pointer_at(step.numbers[0], step.numbers[1])},
                  {{.kind = Kind::drop, .value = {0, 0}, .code = 0, .text = step.words[2]}},
                  {}};
    } else if (verb == "set") {
        controls.set(step.words[0], step.words[1]);
        patience_ = most_patience;
    } else if (verb == "show") {
        stage_.show(step.words[0]);
        ticks_ = {{}, {}};
    } else if (verb == "type") {
        ticks_ = {{{.kind = Kind::text, .text = step.words[0]}}, {}};
    } else if (verb == "frame") {
        stage_.go_to(std::llround(step.numbers[0]));
    } else if (verb == "screenshot") {
        stage_.screenshot(step.words[0]);
    } else if (verb == "controls") {
        for (const LaidOutControl& control : controls.laid_out()) {
            const Region &place = control.place, &seen = control.seen;
            stage_.print(fmt::format("control {} at {} {} {} {} seen {} {} {} {}{}", control.name, place.x, place.y,
                                     place.width, place.height, seen.x, seen.y, seen.width, seen.height,
                                     control.clipped_text ? " clipped" : ""));
        }
    } else if (verb == "measure") {
        stage_.print(fmt::format("{}: {}", step.words[0], clock_.told()));
    } else if (verb == "quit") {
        stage_.quit();
    }
}

std::vector<InputEvent> ScriptPlayer::before_frame(Controls& controls) {
    clock_.count(stage_.pictures());
    if (waiting_) {
        // What a hand did last is asked for with the next frame; two more show what came of it.
        constexpr int settled = 3;
        const bool still = stage_.idle();
        if (still && still_frames_ == 0) clock_.settle();
        still_frames_ = still ? still_frames_ + 1 : 0;
        waiting_ = still_frames_ < settled;
        if (waiting_) return {};
    }
    if (waits_for_work_ && !stage_.is_busy() && !stage_.idle()) return {};
    // With the next frame the window tells it.
    if (std::exchange(waits_for_work_, false)) return {};
    if (!ticks_.empty()) {
        Tick tick = std::move(ticks_.front());
        ticks_.pop_front();
        clock_.move();
        return tick;
    }
    if (patience_ > 0 || next_ == steps_.size()) return {};
    const ScriptStep& step = steps_[next_++];
    try {
        begin(step, controls);
    } catch (const std::invalid_argument& error) {
        fail(error.what());
    }
    return {};
}

void ScriptPlayer::after_frame(Controls& controls) {
    if (patience_ == 0) return;
    patience_ = controls.has_set() ? patience_ - 1 : 0;
    if (patience_ > 0) return;
    if (const auto name = controls.take_unfound()) fail(fmt::format("no control '{}' is shown", *name));
}

}  // namespace matchlight
