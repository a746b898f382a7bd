// Wishes are kept apart from what is shown: a thread is asked for the newest of them when it is free.
#include "preview/session.h"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "compositor/quality.h"
#include "core/atomic_file.h"
#include "core/elapsed.h"
#include "core/error.h"
#include "core/stop.h"
#include "core/version.h"
#include "render/pass_table.h"

namespace matchlight {

namespace {

/// A hand that stands still for so long has come to rest.
constexpr double rest_s = 0.3;
/// Spheres in layers, but none in the shade of another.
constexpr ShotLevel peeled_level{.level = QualityLevel::draft};

}  // namespace

Session::Session(SessionOptions options, Warnings& warnings)
    : options_(std::move(options)), warnings_(warnings), frame_(options_.frame) {
    quick_.thread = std::make_unique<ShotThread>(options_.scene, options_.quiet, warnings, options_.wake);
}

void Session::touch() {
    ++wish_;
    touched_ = Clock::now();
    // What is exact of something else is of no use, and takes time from what is quick.
    give_up(peeled_);
    give_up(exact_);
}

void Session::give_up(Drawer& drawer) {
    if (!std::exchange(drawer.asked, false)) return;
    drawer.thread->give_up();
    drawer.wish = 0;
    passes_ = passes_ || drawer.passes;
}

void Session::give_up() {
    playing_ = false;
    give_up(quick_);
    give_up(peeled_);
    give_up(exact_);
    passes_ = false;
    quick_.wish = peeled_.wish = exact_.wish = wish_;
    changed_ = true;
    options_.print("given up: the picture stays as it is until something is changed");
}

void Session::set_trouble(const std::string& trouble) {
    if (trouble == trouble_) return;  // told already: both threads meet it, and every frame may
    trouble_ = trouble;
    changed_ = true;
    options_.print("error: " + trouble);
}

void Session::attempt(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        if (options_.strict) throw;
        set_trouble(error.what());
    }
}

bool Session::wants_exact() const {
    const bool is_finer = level_.budget || level_.level > QualityLevel::preview || simplifies_spheres();
    return !options_.strict && !playing_ && !dragging_ && is_finer;
}

bool Session::simplifies_spheres() const {
    // Real things are never drawn.
    const auto has_spheres = [](const ObjectSettings& object) { return !object.spheres.empty() && !object.holdout; };
    return !options_.strict && !has_quick_spheres_ && scene_ && std::ranges::any_of(scene_->objects, has_spheres);
}

bool Session::peels_first() const {
    if (!simplifies_spheres() || level_ == peeled_level) return false;
    return std::ranges::any_of(scene_->objects, [](const ObjectSettings& object) {
        return !object.spheres.empty() && !object.holdout &&
               (object.sphere.opacity < 1 || !object.sphere.opacity_column.empty());
    });
}

ShotLevel Session::quick_level() const {
    if (options_.strict) return level_;
    if (simplifies_spheres()) return {.level = QualityLevel::draft, .opaque_spheres = true};
    return {.level = std::min(level_.level, QualityLevel::preview)};
}

std::string Session::sphere_mode() const {
    if (!simplifies_spheres() || !picture_) return "";
    switch (shown_stage_) {
        case Stage::quick:
            return "spheres opaque while it moves";
        case Stage::peeled:
            return "spheres peeled, not yet shading each other";
        case Stage::exact:
            break;
    }
    return "spheres as the level has them";
}

void Session::take(Drawer& drawer, Stage stage) {
    if (!drawer.thread) return;
    ShotNews news = drawer.thread->take();
    const bool is_quick = stage == Stage::quick;
    if (news.facts && is_quick) take_facts(std::move(news.facts));
    if (news.shaders && is_quick) take_shaders(*news.shaders);
    if (news.picture && news.picture->serial == drawer.serial) {
        drawer.asked = false;
        // What is exact of something else by now is of no use.
        if (is_quick || drawer.wish == wish_) take_picture(std::move(*news.picture), stage);
    }
    if (!news.failure) return;
    drawer.asked = false;
    playing_ = false;
    const bool shows = picture_ && (picture_->composite.width() > 0 || picture_->plate.width() > 0);
    if (!shows || options_.strict) std::rethrow_exception(news.failure);
    attempt([&] { std::rethrow_exception(news.failure); });
}

void Session::take_facts(std::shared_ptr<const ShotFacts> facts) {
    const bool first = !facts_;
    facts_ = std::move(facts);
    if (first) {
        level_ = facts_->level;
        if (options_.level) level_ = {.level = *options_.level, .budget = false};
        history_ = std::make_unique<SceneHistory>(SceneText::load(options_.scene));
    } else {
        history_->read_again();
    }
    take_text(history_->text());
    shader_trouble_.clear();
    trouble_.clear();
    has_quick_spheres_ = false;
    awaits_first_exact_ = true;
    const std::int64_t count = facts_->footage.frame_count;
    if (first && options_.frame >= count) {
        throw InputError(facts_->footage.path, fmt::format("has no frame {}", options_.frame),
                         fmt::format("it has {}, counted from 0", count));
    }
    touch();
    changed_ = true;
}

void Session::take_picture(ShotPicture picture, Stage stage) {
    const bool exact = stage == Stage::exact;
    // What a hand can follow need not be simplified. A first picture says nothing: much is made with it that stays.
    constexpr double followed_ms = 100;
    const bool is_first = std::exchange(awaits_first_exact_, awaits_first_exact_ && !exact);
    constexpr double lost_ms = 3 * followed_ms;
    if (exact && !is_first && picture.ms < followed_ms) has_quick_spheres_ = true;
    if (stage == Stage::quick && picture.ms > lost_ms) has_quick_spheres_ = false;
    shown_stage_ = stage;
    // Where frames cannot be decoded, the next one is shown.
    if (quick_.wish == wish_) frame_ = picture.frame;
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
    constexpr std::size_t most_times = 120;
    if (picture_times_ms_.size() == most_times) picture_times_ms_.erase(picture_times_ms_.begin());
    picture_times_ms_.push_back(static_cast<float>(picture.ms));
    picture_ = std::move(picture);
    ++pictures_;
    changed_ = true;
}

void Session::take_shaders(const ShaderReload& shaders) {
    touch();
    changed_ = true;
    shader_trouble_ = shaders.errors.empty() ? "" : shaders.errors.front();
    for (const std::string& program : shaders.reloaded) options_.print("new: " + program);
    for (const std::string& error : shaders.errors) options_.print("error: " + error);
}

void Session::update() {
    take(quick_, Stage::quick);
    take(peeled_, Stage::peeled);
    take(exact_, Stage::exact);
    if (!facts_) return;
    if (playing_ && picture_ && !quick_.asked && quick_.wish == wish_ && next_due_s() <= 0.0) touch();
    // One picture at a time: so what is shown while a slider moves is as new as it can be.
    if (!quick_.asked && quick_.wish != wish_) ask(quick_, quick_level());
    if (!wants_exact() || quick_.asked || quick_.wish != wish_ || exact_.asked || exact_.wish == wish_) return;
    if (seconds_since(touched_) < rest_s) return;
    ask_at_rest();
}

void Session::ask_at_rest() {
    if (peeled_.asked) return;
    if (peels_first() && peeled_.wish != wish_) {
        ask_own_thread(peeled_, peeled_level);
    } else {
        ask_own_thread(exact_, level_);
    }
}

void Session::ask_own_thread(Drawer& drawer, const ShotLevel& level) {
    if (!drawer.thread)
        drawer.thread = std::make_unique<ShotThread>(options_.scene, options_.quiet, warnings_, options_.wake);
    ask(drawer, level);
}

void Session::ask(Drawer& drawer, const ShotLevel& level) {
    PictureRequest request{.frame = frame_,
                           .backwards = backwards_,
                           .due_s = {},
                           .level = level,
                           .scene = scene_,
                           .dragging = dragging_,
                           .free_view = free_view_,
                           .watched_pass = watched_pass_,
                           .probe = shown_probe_,
                           .composite = wanted_.composite,
                           .plate = wanted_.plate,
                           .difference = wanted_.difference,
                           .passes = passes_};
    if (wanted_.truth || wanted_.difference) request.truth = options_.truth;
    if (playing_) request.due_s = clock_.time_s(Clock::now());
    // What is measured is what is shown in the end.
    const bool last = &drawer == &exact_ || !wants_exact();
    request.passes = passes_ && last;
    drawer.passes = request.passes;
    if (last) passes_ = false;
    drawer.serial = drawer.thread->ask(request);
    drawer.wish = wish_;
    drawer.asked = true;
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
    if (quick_.asked || quick_.wish != wish_ || !quick_.thread->idle()) return false;
    return !wants_exact() || (!exact_.asked && exact_.wish == wish_);
}

double Session::busy_s() const {
    double busy_s = quick_.thread->busy_s();
    for (const Drawer* drawer : {&peeled_, &exact_}) {
        if (drawer->thread) busy_s = std::max(busy_s, drawer->thread->busy_s());
    }
    return busy_s;
}

bool Session::is_told() const {
    constexpr double told_after_s = 0.5;
    return busy_s() > told_after_s;
}

WorkStage Session::stage() const {
    const Drawer* busiest = &quick_;
    for (const Drawer* drawer : {&peeled_, &exact_}) {
        if (drawer->thread && drawer->thread->busy_s() > busiest->thread->busy_s()) busiest = drawer;
    }
    return busiest->thread->stage();
}

std::optional<double> Session::next_due_s() const {
    if (playing_ && picture_ && picture_->next_time_s) return *picture_->next_time_s - clock_.time_s(Clock::now());
    if (playing_) return 0.0;
    if (wants_exact() && exact_.wish != wish_) return rest_s - seconds_since(touched_);
    return std::nullopt;
}

void Session::go_to(std::int64_t frame, bool backwards) {
    frame_ = std::clamp<std::int64_t>(frame, 0, std::max<std::int64_t>(0, frame_count() - 1));
    backwards_ = backwards;
    touch();
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
    touch();
    if (!on || !picture_) return;
    const bool at_end = picture_->frame + 1 >= frame_count();
    if (at_end) frame_ = 0;
    backwards_ = false;
    clock_.start(at_end ? 0 : picture_->time_s, Clock::now());
}

void Session::set_level(const ShotLevel& level) {
    level_ = level;
    touch();
}

void Session::want(const WantedPictures& wanted) {
    if (wanted == wanted_) return;
    wanted_ = wanted;
    touch();
}

void Session::set_free_view(const std::optional<CameraView>& view) {
    free_view_ = view;
    touch();
}

void Session::watch(const std::string& pass) {
    if (pass == watched_pass_) return;
    watched_pass_ = pass;
    touch();
}

void Session::show_probe(const std::optional<ProbeForm>& form) {
    if (form == shown_probe_) return;
    shown_probe_ = form;
    touch();
}

void Session::write_passes() {
    if (!picture_ || picture_->passes.empty()) return;
    attempt([&] {
        std::filesystem::path path = options_.scene;
        path.replace_extension(fmt::format("frame{:04}.passes.txt", picture_->frame));
        write_text_file(path,
                        fmt::format("matchlight {}: {}, frame {}, level {}\n{}\n", version, options_.scene.string(),
                                    picture_->frame, name_of(level_.level), pass_table(picture_->passes)));
        options_.print(fmt::format("written: {}", path.string()));
    });
}

void Session::ask_for_passes() {
    passes_ = true;
    touch();
}

void Session::reload() {
    quick_.thread->reload();
    for (const Drawer* drawer : {&peeled_, &exact_}) {
        if (drawer->thread) drawer->thread->reload();
    }
}

}  // namespace matchlight
