// The loop: events, the clip's time, shaders on disk, one picture.
#include "preview/preview.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "compositor/quality.h"
#include "core/error.h"
#include "core/stop.h"
#include "core/version.h"
#include "media/image_io.h"
#include "preview/picture_view.h"
#include "preview/playback_clock.h"
#include "preview/shot.h"
#include "preview/window.h"
#include "render/pass_table.h"

namespace matchlight {

namespace {

using Clock = PlaybackClock::Clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

QualityLevel next_level(QualityLevel level) {
    constexpr int levels = static_cast<int>(QualityLevel::reference) + 1;
    return static_cast<QualityLevel>((static_cast<int>(level) + 1) % levels);
}

double pixel_aspect_of(const FootageInfo& footage) {
    const Rational& aspect = footage.sample_aspect;
    if (aspect.numerator <= 0 || aspect.denominator <= 0) return 1;
    const double stored = static_cast<double>(aspect.numerator) / aspect.denominator;
    return footage.format.rotation_deg % 180 == 0 ? stored : 1 / stored;
}

class Preview {
public:
    Preview(const PreviewOptions& options, Warnings& warnings);

    void press(PreviewAction action);
    /// Until the user quits.
    void run();
    void save_snapshot();
    PreviewResult result() const;

private:
    void go_to(std::int64_t frame);
    void step(std::int64_t frames);
    void set_switches(const ShotSwitches& switches);
    void explain();
    void reload_scene();
    void reload_shaders();
    /// Shows the frame whose time has come; false while it is the one shown already.
    void play_on();
    /// Seconds for which nothing needs doing.
    double idle_s();
    void update_picture();
    void draw();
    /// Does it, or says why it cannot be done; what was shown stays.
    void attempt(const std::function<void()>& action);
    std::string title() const;
    PictureSize displayed_picture();

    const PreviewOptions& options_;
    Warnings& warnings_;
    PreviewWindow window_;
    std::unique_ptr<Shot> shot_;
    PictureView view_;
    std::optional<PlateFrame> frame_;
    Eigen::Vector2i drawn_px_ = Eigen::Vector2i::Zero();
    PlaybackClock clock_;
    Clock::time_point shaders_seen_ = Clock::now();
    bool playing_ = false;
    bool plate_alone_ = false;
    bool quit_ = false;
    bool stale_ = true;  // the picture is not of this frame and these switches
    double frame_ms_ = 0;
    std::string trouble_;         // of the last attempt
    std::string shader_trouble_;  // until it is mended
};

Preview::Preview(const PreviewOptions& options, Warnings& warnings) : options_(options), warnings_(warnings) {
    shot_ = std::make_unique<Shot>(window_.context(), options.scene, options.quiet, warnings);
    if (options.level) {
        ShotSwitches switches = shot_->switches();
        switches.level = *options.level;
        switches.budget = false;
        shot_->set_switches(switches);
    }
    const std::int64_t count = shot_->frames().info().frame_count;
    if (options.frame >= count) {
        throw InputError(shot_->frames().info().path, fmt::format("has no frame {}", options.frame),
                         fmt::format("it has {}, counted from 0", count));
    }
    go_to(options.frame);
}

void Preview::attempt(const std::function<void()>& action) {
    try {
        action();
        trouble_.clear();
    } catch (const InputError& error) {
        trouble_ = error.what();
        playing_ = false;
        options_.print("error: " + trouble_);
    }
}

void Preview::go_to(std::int64_t frame) {
    FrameCache& frames = shot_->frames();
    const std::int64_t last = std::max<std::int64_t>(0, frames.info().frame_count - 1);
    std::optional<PlateFrame> found = frames.at_or_after(std::min(frame, last));
    if (!found) found = frames.before(last + 1);
    if (!found) throw InputError(frames.info().path, "no frame of it can be decoded");
    frame_ = std::move(found);
    stale_ = true;
    if (playing_) clock_.start(frame_->time_s(), Clock::now());
}

void Preview::step(std::int64_t frames) {
    playing_ = false;
    const std::int64_t from = frame_->index();
    go_to(from + frames);
    // Frames that cannot be decoded are passed over, backwards too.
    if (frames < 0 && frame_->index() >= from) {
        if (auto earlier = shot_->frames().before(from)) frame_ = std::move(earlier);
    }
}

void Preview::set_switches(const ShotSwitches& switches) {
    shot_->set_switches(switches);
    stale_ = true;
}

void Preview::press(PreviewAction action) {
    ShotSwitches switches = shot_->switches();
    switch (action) {
        case PreviewAction::play:
            playing_ = !playing_;
            if (playing_ && !shot_->frames().at_or_after(frame_->index() + 1)) go_to(0);
            clock_.start(frame_->time_s(), Clock::now());
            return;
        case PreviewAction::step_back:
            return step(-1);
        case PreviewAction::step_on:
            return step(1);
        case PreviewAction::ten_back:
            return step(-10);
        case PreviewAction::ten_on:
            return step(10);
        case PreviewAction::first:
            return go_to(0);
        case PreviewAction::last:
            return go_to(shot_->frames().info().frame_count - 1);
        case PreviewAction::bloom:
            switches.bloom = !switches.bloom;
            return set_switches(switches);
        case PreviewAction::glare:
            switches.glare = !switches.glare;
            return set_switches(switches);
        case PreviewAction::dazzle:
            switches.dazzle = !switches.dazzle;
            return set_switches(switches);
        case PreviewAction::exposure:
            switches.exposure = !switches.exposure;
            return set_switches(switches);
        case PreviewAction::shadow:
            switches.shadow = !switches.shadow;
            return set_switches(switches);
        case PreviewAction::level:
            switches.level = next_level(switches.level);
            switches.budget = false;
            return set_switches(switches);
        case PreviewAction::plate:
            plate_alone_ = !plate_alone_;
            stale_ = true;
            return;
        case PreviewAction::explain:
            return explain();
        case PreviewAction::reload:
            return reload_scene();
        case PreviewAction::help:
            return options_.print(preview_keys_text());
        case PreviewAction::quit:
            quit_ = true;
            return;
    }
}

void Preview::explain() {
    update_picture();  // so that what is made once is not part of it
    options_.print(fmt::format("frame {}\n{}", frame_->index(), pass_table(shot_->passes(*frame_))));
}

void Preview::reload_scene() {
    auto shot = std::make_unique<Shot>(window_.context(), options_.scene, options_.quiet, warnings_);
    if (options_.level) {
        ShotSwitches switches = shot->switches();
        switches.level = shot_->switches().level;
        switches.budget = false;
        shot->set_switches(switches);
    }
    shot_ = std::move(shot);
    shader_trouble_.clear();
    go_to(frame_->index());
}

void Preview::reload_shaders() {
    constexpr double look_every_s = 0.3;
    if (seconds_since(shaders_seen_) < look_every_s) return;
    shaders_seen_ = Clock::now();
    const ShaderReload reload = shot_->reload_shaders();
    if (!reload.files_changed) return;
    stale_ = true;
    shader_trouble_ = reload.errors.empty() ? "" : reload.errors.front();
    for (const std::string& program : reload.reloaded) options_.print("new: " + program);
    for (const std::string& error : reload.errors) options_.print("error: " + error);
}

void Preview::play_on() {
    if (!playing_) return;
    const Clock::time_point now = Clock::now();
    const double due_s = clock_.time_s(now);
    FrameCache& frames = shot_->frames();
    std::optional<PlateFrame> next = frames.at_or_after(frame_->index() + 1);
    for (; next && next->time_s() <= due_s; next = frames.at_or_after(frame_->index() + 1)) {
        frame_ = std::move(next);
        stale_ = true;
    }
    if (!next) playing_ = false;
    // Where even decoding takes longer than the clip, its time waits: otherwise ever more frames would be dropped.
    constexpr double latest_s = 1;
    if (seconds_since(now) > latest_s) clock_.start(frame_->time_s(), Clock::now());
}

double Preview::idle_s() {
    constexpr double longest_s = 0.1;  // shaders and signals are looked for that often
    if (!playing_) return longest_s;
    const std::optional<PlateFrame> next = shot_->frames().at_or_after(frame_->index() + 1);
    const double until_next_s = next ? next->time_s() - clock_.time_s(Clock::now()) : 0;
    return std::clamp(until_next_s, 0.0, longest_s);
}

void Preview::update_picture() {
    if (!stale_) return;
    stale_ = false;
    const Clock::time_point start = Clock::now();
    const PlateFormat& format = frame_->format();
    view_.set_picture(plate_alone_ ? frame_->rgb8({0, 0, format.width, format.height}) : shot_->composited(*frame_),
                      pixel_aspect_of(shot_->frames().info()));
    frame_ms_ = 1000 * seconds_since(start);
    drawn_px_.setZero();
}

void Preview::draw() {
    const bool damaged = window_.take_damage();
    const Eigen::Vector2i size = window_.framebuffer_size();
    if (size.x() <= 0 || size.y() <= 0 || (size == drawn_px_ && !damaged)) return;
    window_.context().make_current();
    view_.draw(size.x(), size.y());
    view_.present();
    window_.swap();
    drawn_px_ = size;
}

std::string Preview::title() const {
    const ShotSwitches& switches = shot_->switches();
    std::string on;
    const auto add = [&](bool is_on, const char* name) {
        if (is_on) on += (on.empty() ? "" : ", ") + std::string(name);
    };
    add(switches.bloom, "bloom");
    add(switches.glare, "glare");
    add(switches.dazzle && (switches.bloom || switches.glare), "dazzle");
    add(switches.exposure, "exposure");
    add(switches.shadow, "shadow");
    std::string text =
        fmt::format("{}: frame {} of {}, {:.3f} s | {} | {} | {:.0f} ms", printable(options_.scene.filename().string()),
                    frame_->index(), shot_->frames().info().frame_count, frame_->time_s(),
                    switches.budget ? "budget" : name_of(switches.level),
                    plate_alone_ ? "plate alone"
                    : on.empty() ? "no effects"
                                 : on,
                    frame_ms_);
    const std::string& trouble = shader_trouble_.empty() ? trouble_ : shader_trouble_;
    if (!trouble.empty()) text += " | " + trouble;
    return text;
}

PictureSize Preview::displayed_picture() {
    const FootageInfo& footage = shot_->frames().info();
    return displayed_size(footage.format.width, footage.format.height, pixel_aspect_of(footage));
}

void Preview::run() {
    if (options_.size) {
        window_.show(*options_.size);
    } else {
        window_.show_fitted(displayed_picture());
    }
    std::vector<PreviewAction> actions = options_.keys;
    update_picture();  // what cannot be shown at all is an error
    while (!quit_) {
        for (const PreviewAction action : actions) attempt([&] { press(action); });
        if (stop_requested()) throw InputError(options_.scene, "the preview was stopped by a signal");
        if (stale_ || playing_) attempt([&] { play_on(); });
        reload_shaders();
        if (stale_) attempt([&] { update_picture(); });
        draw();
        window_.set_title(title());
        window_.wait(stale_ ? 0 : idle_s());
        actions = window_.take_actions();
    }
}

void Preview::save_snapshot() {
    for (const PreviewAction action : options_.keys) {
        if (!quit_) press(action);
    }
    update_picture();
    const PictureSize picture = displayed_picture();
    const Eigen::Vector2i own(static_cast<int>(picture.width), static_cast<int>(picture.height));
    drawn_px_ = options_.size.value_or(own);
    view_.draw(drawn_px_.x(), drawn_px_.y());
    write_png8(options_.snapshot, view_.shown(),
               {{"Software", fmt::format("matchlight {}\n{}", version, shot_->scene().effective_toml)}});
}

PreviewResult Preview::result() const {
    return {.frame = frame_->index(), .time_s = frame_->time_s(), .window_px = drawn_px_};
}

}  // namespace

PreviewResult run_preview(const PreviewOptions& options, Warnings& warnings) {
    Preview preview(options, warnings);
    if (options.snapshot.empty()) {
        preview.run();
    } else {
        preview.save_snapshot();
    }
    return preview.result();
}

}  // namespace matchlight
