// Wishes are kept apart from what is shown: the thread is asked for the newest of them.
#include "preview/session.h"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "core/error.h"
#include "core/stop.h"
#include "render/pass_table.h"

namespace matchlight {

using Clock = PlaybackClock::Clock;

Session::Session(SessionOptions options, Warnings& warnings)
    : options_(std::move(options)),
      frame_(options_.frame),
      thread_(options_.scene, options_.quiet, warnings, options_.wake) {}

void Session::set_trouble(const std::string& trouble) {
    trouble_ = trouble;
    changed_ = true;
    if (!trouble.empty()) options_.print("error: " + trouble);
}

void Session::take(ShotNews news) {
    if (news.facts) take_facts(std::move(news.facts));
    if (news.picture) take_picture(std::move(*news.picture));
    if (news.shaders) take_shaders(*news.shaders);
    if (!news.failure) return;
    asked_ = false;
    playing_ = false;
    const bool shows = picture_ && (picture_->composite.width() > 0 || picture_->plate.width() > 0);
    if (!shows || options_.strict) std::rethrow_exception(news.failure);
    try {
        std::rethrow_exception(news.failure);
    } catch (const InputError& error) {
        set_trouble(error.what());
    }
}

void Session::take_facts(std::shared_ptr<const ShotFacts> facts) {
    const bool first = !facts_;
    const QualityLevel level = first ? options_.level.value_or(facts->switches.level) : switches_.level;
    facts_ = std::move(facts);
    switches_ = facts_->switches;
    if (options_.level) {
        switches_.level = level;
        switches_.budget = false;
    }
    shader_trouble_.clear();
    trouble_.clear();
    const std::int64_t count = facts_->footage.frame_count;
    if (first && options_.frame >= count) {
        throw InputError(facts_->footage.path, fmt::format("has no frame {}", options_.frame),
                         fmt::format("it has {}, counted from 0", count));
    }
    stale_ = true;
    changed_ = true;
}

void Session::take_picture(ShotPicture picture) {
    asked_ = false;
    // Where frames cannot be decoded, the next one is shown.
    if (!stale_) frame_ = picture.frame;
    if (playing_) {
        frame_ = picture.frame;
        if (!picture.next_time_s) playing_ = false;
        // Where even decoding takes longer than the clip, its time waits: otherwise ever more frames would be dropped.
        constexpr double latest_s = 1;
        if (picture.walk_s > latest_s) clock_.start(picture.time_s, Clock::now());
    }
    if (!picture.passes.empty()) options_.print(fmt::format("frame {}\n{}", picture.frame, pass_table(picture.passes)));
    if (picture.passes.empty() && picture_) picture.passes = std::move(picture_->passes);
    if (picture.composite.width() == 0 && picture_) picture.composite = std::move(picture_->composite);
    picture_ = std::move(picture);
    trouble_.clear();
    changed_ = true;
}

void Session::take_shaders(const ShaderReload& shaders) {
    stale_ = true;
    changed_ = true;
    shader_trouble_ = shaders.errors.empty() ? "" : shaders.errors.front();
    for (const std::string& program : shaders.reloaded) options_.print("new: " + program);
    for (const std::string& error : shaders.errors) options_.print("error: " + error);
}

void Session::update() {
    take(thread_.take());
    if (playing_ && picture_ && !asked_ && !stale_ && next_due_s() <= 0.0) stale_ = true;
    // One picture at a time: so what is shown while a slider moves is as new as it can be.
    if (stale_ && facts_ && !asked_) ask();
}

void Session::ask() {
    PictureRequest request{.frame = frame_,
                           .backwards = backwards_,
                           .due_s = {},
                           .switches = switches_,
                           .composite = wanted_.composite,
                           .plate = wanted_.plate,
                           .difference = wanted_.difference,
                           .passes = passes_};
    if (wanted_.truth || wanted_.difference) request.truth = options_.truth;
    if (playing_) request.due_s = clock_.time_s(Clock::now());
    thread_.ask(request);
    passes_ = false;
    stale_ = false;
    asked_ = true;
}

void Session::settle() {
    constexpr auto nap = std::chrono::milliseconds(1);
    while (!idle()) {
        if (stop_requested()) throw InputError(options_.scene, "the preview was stopped by a signal");
        std::this_thread::sleep_for(nap);
        update();
    }
}

bool Session::idle() const {
    return !stale_ && !asked_ && thread_.idle();
}

std::optional<double> Session::next_due_s() const {
    if (!playing_ || !picture_ || !picture_->next_time_s) return playing_ ? std::optional(0.0) : std::nullopt;
    return *picture_->next_time_s - clock_.time_s(Clock::now());
}

void Session::go_to(std::int64_t frame, bool backwards) {
    frame_ = std::clamp<std::int64_t>(frame, 0, std::max<std::int64_t>(0, frame_count() - 1));
    backwards_ = backwards;
    stale_ = true;
    if (playing_ && picture_) {
        const double fps = facts_->footage.fps;
        const double ahead = fps > 0 ? static_cast<double>(frame_ - picture_->frame) / fps : 0;
        clock_.start(picture_->time_s + ahead, Clock::now());
    }
}

void Session::step(std::int64_t frames) {
    playing_ = false;
    go_to(frame_ + frames, frames < 0);
}

void Session::play(bool on) {
    playing_ = on;
    if (!on || !picture_) return;
    const bool at_end = picture_->frame + 1 >= frame_count();
    if (at_end) frame_ = 0;
    backwards_ = false;
    clock_.start(at_end ? 0 : picture_->time_s, Clock::now());
    stale_ = true;
}

void Session::set_switches(const ShotSwitches& switches) {
    switches_ = switches;
    stale_ = true;
}

void Session::want(const WantedPictures& wanted) {
    if (wanted == wanted_) return;
    wanted_ = wanted;
    stale_ = true;
}

void Session::ask_for_passes() {
    passes_ = true;
    stale_ = true;
}

void Session::reload() {
    thread_.reload();
}

}  // namespace matchlight
