// The loop: events, what came of the shot's thread, one frame of the window.
#include "preview/preview.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "compositor/quality.h"
#include "core/atomic_file.h"
#include "core/elapsed.h"
#include "core/error.h"
#include "core/stop.h"
#include "core/version.h"
#include "media/image_io.h"
#include "preview/flight.h"
#include "preview/gui.h"
#include "preview/hand.h"
#include "preview/script_player.h"
#include "preview/truth_picture.h"
#include "preview/window.h"
#include "preview/window_parts.h"
#include "preview/window_settings.h"

namespace matchlight {

namespace {

using Clock = PlaybackClock::Clock;

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

    /// Until the user quits.
    void run();
    void save_snapshot();
    PreviewResult result() const;

private:
    void press(PreviewAction action);
    void press_pending();
    void press_switch(PreviewAction action);
    void press_view(PreviewAction action);
    void handle(const InputEvent& event);
    void start_script();
    void take_pictures();
    void update_wishes();
    void show_window();
    void lay_out();
    /// What looks otherwise than before; where the window was exposed, all of it is shown again.
    void draw(bool exposed);
    void screenshot(const std::filesystem::path& path);
    double rests_s_before_drawing() const;
    double idle_s() const;
    std::string title() const;
    PictureSize displayed_picture() const;

    const PreviewOptions& options_;
    PreviewWindow window_;
    Session session_;
    PictureView view_;
    Canvas canvas_;
    Hand hand_;
    Controls controls_;
    WindowState state_;
    WindowSettings settings_;
    std::unique_ptr<Gui> gui_;  // none where there is just a snapshot
    std::unique_ptr<ScriptPlayer> script_;
    std::vector<PreviewAction> pending_;  // keys pressed at the start
    Layout layout_;
    Eigen::Vector2i drawn_px_ = Eigen::Vector2i::Zero();
    Clock::time_point last_frame_ = Clock::now();
    int frames_to_draw_ = 0;
    std::int64_t taken_pictures_ = 0;
    bool quit_ = false;
};

Preview::Preview(const PreviewOptions& options, Warnings& warnings)
    : options_(options),
      session_({.scene = options.scene,
                .frame = options.frame,
                .level = options.level,
                .truth = options.truth,
                .quiet = options.quiet,
                .strict = !options.snapshot.empty(),
                .print = options.print,
                .wake = &PreviewWindow::wake},
               warnings),
      pending_(options.keys) {
    if (!options.truth.empty()) check_truth(options.truth);
    state_.has_truth = !options.truth.empty();
}

void Preview::press(PreviewAction action) {
    switch (action) {
        case PreviewAction::play:
            session_.play(!session_.playing());
            break;
        case PreviewAction::step_back:
            session_.step(-1);
            break;
        case PreviewAction::step_on:
            session_.step(1);
            break;
        case PreviewAction::ten_back:
            session_.step(-10);
            break;
        case PreviewAction::ten_on:
            session_.step(10);
            break;
        case PreviewAction::first:
            session_.go_to(0);
            break;
        case PreviewAction::last:
            session_.go_to(session_.frame_count() - 1, true);
            break;
        case PreviewAction::explain:
            session_.ask_for_passes();
            break;
        case PreviewAction::reload:
            session_.reload();
            break;
        case PreviewAction::undo:
            session_.undo();
            break;
        case PreviewAction::redo:
            session_.redo();
            break;
        case PreviewAction::free_view:
            toggle_flight(session_);
            break;
        case PreviewAction::save:
            session_.save();
            break;
        case PreviewAction::help:
            state_.help = !state_.help;
            session_.print(preview_keys_text());
            break;
        case PreviewAction::panels:
            state_.layout.panels = !state_.layout.panels;
            break;
        case PreviewAction::give_up:
            if (session_.is_told()) {
                session_.give_up();
            } else {
                quit_ = true;
            }
            break;
        case PreviewAction::quit:
            quit_ = true;
            break;
        default:
            press_switch(action);
            press_view(action);
    }
    update_wishes();
}

void Preview::press_pending() {
    const PreviewAction action = pending_.front();
    pending_.erase(pending_.begin());
    press(action);
    if (!options_.snapshot.empty()) session_.settle();
}

void Preview::press_switch(PreviewAction action) {
    if (session_.facts() == nullptr) return;
    const Scene& scene = session_.scene();
    const std::string off = "off", automatic = "auto";
    if (action == PreviewAction::bloom) session_.toggle("effects.bloom", off, automatic);
    if (action == PreviewAction::glare) session_.toggle("effects.glare", off, automatic);
    if (action == PreviewAction::dazzle) {
        // Without dazzle objects send all that they have to what spills: off is a strength of none.
        if (!scene.effects.dazzle) {
            session_.set("effects.dazzle.strength", 0.0);
        } else {
            session_.toggle("effects.dazzle.strength", 0.0, 1.0);
        }
    }
    if (action == PreviewAction::exposure) {
        // Matched exposure is what holds without exposure control: the switch is between that and the simulated one.
        const bool is_on = scene.effects.exposure && scene.effects.exposure->mode == ExposureMode::simulated;
        session_.set("effects.exposure.mode", std::string(is_on ? "matched" : "simulated"));
    }
    if (action == PreviewAction::shadow) session_.set("surface.shadow", !scene.surface.shadow);
    if (action == PreviewAction::level) session_.set_level({.level = next_level(session_.level().level)});
}

void Preview::press_view(PreviewAction action) {
    const auto show = [&](ShownKind kind) { canvas_.shown = canvas_.shown == kind ? ShownKind::composite : kind; };
    if (action == PreviewAction::plate) show(ShownKind::plate);
    if (action == PreviewAction::truth && state_.has_truth) show(ShownKind::truth);
    if (action == PreviewAction::difference) show(ShownKind::difference);
    if (action == PreviewAction::wipe) canvas_.wipe = !canvas_.wipe;
    if (action == PreviewAction::fit) canvas_.fit();
    if (action == PreviewAction::whole_pixels) canvas_.set_zoom(1);
}

void Preview::update_wishes() {
    // Of what lies between two keys pressed at the start, nothing is to be seen.
    if (!pending_.empty()) return session_.want({.composite = false});
    if (session_.free_view()) return session_.want({});
    const ShownKind shown = canvas_.shown;
    const bool wipe = canvas_.wipe;
    session_.want({.composite = shown != ShownKind::plate || wipe || !session_.watched_pass().empty(),
                   .plate = shown == ShownKind::plate || (wipe && shown == ShownKind::composite),
                   .truth = shown == ShownKind::truth,
                   .difference = shown == ShownKind::difference});
}

void Preview::take_pictures() {
    if (!session_.take_change()) return;
    frames_to_draw_ = std::max(frames_to_draw_, 2);
    if (!session_.picture() || session_.facts() == nullptr || session_.picture_count() == taken_pictures_) return;
    taken_pictures_ = session_.picture_count();
    const ShotPicture& picture = *session_.picture();
    const double aspect = pixel_aspect_of(session_.facts()->footage);
    const auto set = [&](ShownKind kind, const Image8& image) {
        if (image.width() > 0) {
            canvas_.set_picture(kind, image, aspect);
        } else {
            canvas_.remove_picture(kind);
        }
    };
    set(ShownKind::composite, picture.composite);
    set(ShownKind::plate, picture.plate);
    set(ShownKind::truth, picture.truth);
    set(ShownKind::difference, picture.difference);
    set(ShownKind::texture, picture.watched_picture);
}

void Preview::start_script() {
    script_ = std::make_unique<ScriptPlayer>(
        options_.script, ScriptStage{.idle = [this] { return session_.idle() && hand_.idle() && pending_.empty(); },
                                     .show =
                                         [this](const std::string& name) {
                                             state_.panel = panel_named(name);
                                             state_.open_panel = true;
                                         },
                                     .go_to = [this](std::int64_t frame) { session_.go_to(frame); },
                                     .screenshot = [this](const std::filesystem::path& path) { screenshot(path); },
                                     .pictures = [this] { return session_.picture_count(); },
                                     .is_busy = [this] { return session_.is_told(); },
                                     .print = options_.print,
                                     .quit = [this] { quit_ = true; }});
}

void Preview::screenshot(const std::filesystem::path& path) {
    check_output(path, options_.overwrite);
    write_png8(path, view_.shown());
}

void Preview::handle(const InputEvent& event) {
    frames_to_draw_ = std::max(frames_to_draw_, 3);  // ImGui shows what came of a press a frame or two later
    const bool types = gui_->wants_text() && event.kind == InputEvent::Kind::key;
    if (!types) {
        if (const std::optional<PreviewAction> action = action_of(event)) press(*action);
    }
    gui_->feed(event);
    if (event.kind == InputEvent::Kind::drop && session_.facts() != nullptr) {
        session_.attempt([&] { hand_.drop(event.text, gui_->pointer_px(), layout_.picture, canvas_, session_); });
    }
}

void Preview::lay_out() {
    const Clock::time_point now = Clock::now();
    // A script's frames are all as long, so that it plays the same way on every machine.
    const double seconds =
        script_ && !script_->finished() ? 1.0 / 60 : std::chrono::duration<double>(now - last_frame_).count();
    last_frame_ = now;
    gui_->begin(drawn_px_, seconds);
    controls_.begin_frame();
    layout_ = matchlight::lay_out(drawn_px_, state_.layout);
    canvas_.leads_camera = session_.free_view().has_value();
    canvas_.lay_out(layout_.picture, state_.layout.scale);
    session_.attempt([&] { hand_.lay_out(layout_.picture, state_.layout.scale, canvas_, session_); });
    lay_out_flight(layout_.picture, canvas_, hand_.holds(), session_);
    WindowParts parts{state_,    session_,     canvas_,
                      controls_, hand_.says(), [this](PreviewAction action) { press(action); }};
    try {
        lay_out_window(layout_, parts);
    } catch (const InputError& error) {
        // ImGui's frame is not whole: there is no going on.
        throw InputError(options_.script, error.what());
    }
    update_wishes();
    if (!controls_.is_held() && !canvas_.hand_is_free()) session_.end_drag();
}

void Preview::draw(bool exposed) {
    window_.context().make_current();
    lay_out();
    std::vector<Region> changed = gui_->end();
    if (canvas_.take_change(layout_.picture)) changed.push_back(layout_.picture);
    if (view_.begin(drawn_px_.x(), drawn_px_.y())) changed.push_back(view_.target().bounds());
    for (const Region& part : apart(std::move(changed))) {
        view_.begin_part(part);
        canvas_.draw(view_, layout_.picture);
        gui_->draw(view_.target(), part);
        exposed = true;
    }
    if (!exposed) return;
    view_.present();
    window_.swap();
}

double Preview::rests_s_before_drawing() const {
    // Where a processor draws, every frame of the window takes time from the picture that is waited for.
    constexpr double between_frames_s = 1.0 / 30;
    if (session_.idle() || session_.has_change()) return 0;
    return between_frames_s - seconds_since(last_frame_);
}

double Preview::idle_s() const {
    constexpr double longest_s = 0.1;  // signals are looked for that often, and what takes long is told
    if (frames_to_draw_ > 0 || (script_ && !script_->finished()) || !pending_.empty()) return 0.002;
    return std::clamp(session_.next_due_s().value_or(longest_s), 0.001, longest_s);
}

std::string Preview::title() const {
    if (!session_.picture()) return fmt::format("{}: loading", printable(options_.scene.filename().string()));
    const EffectSettings& effects = session_.scene().effects;
    std::string on;
    const auto add = [&](bool is_on, const char* name) {
        if (is_on) on += (on.empty() ? "" : ", ") + std::string(name);
    };
    add(effects.bloom.has_value(), "bloom");
    add(effects.glare.has_value(), "glare");
    add(effects.depth_of_field.has_value(), "depth of field");
    add(effects.exposure && effects.exposure->mode == ExposureMode::simulated, "exposure");
    add(session_.scene().surface.shadow, "shadow");
    const ShotPicture& picture = *session_.picture();
    std::string text = fmt::format("{}: frame {} of {}, {:.3f} s | {} | {} | {:.0f} ms",
                                   printable(options_.scene.filename().string()), picture.frame, session_.frame_count(),
                                   picture.time_s, session_.level().budget ? "budget" : name_of(session_.level().level),
                                   session_.free_view()                ? "free camera"
                                   : canvas_.shown == ShownKind::plate ? "plate alone"
                                   : on.empty()                        ? "no effects"
                                                                       : on,
                                   picture.ms);
    if (!session_.trouble().empty()) text += " | " + session_.trouble();
    return text;
}

PictureSize Preview::displayed_picture() const {
    const FootageInfo& footage = session_.facts()->footage;
    return displayed_size(footage.format.width, footage.format.height, pixel_aspect_of(footage));
}

void Preview::show_window() {
    const bool remembers = options_.script.empty();
    if (remembers) settings_ = load_window_settings();
    state_.layout.scale = window_.content_scale();
    state_.layout.panel_width = settings_.panel_width;
    if (options_.size) {
        window_.show(*options_.size);
    } else {
        const Eigen::Vector2i usual = settings_.size_px.value_or(Eigen::Vector2i(1280, 720));
        window_.show_fitted({static_cast<double>(usual.x()), static_cast<double>(usual.y())});
    }
    gui_ = std::make_unique<Gui>(state_.layout.scale);
    if (!options_.script.empty()) start_script();
}

void Preview::run() {
    show_window();
    while (!quit_) {
        if (stop_requested()) throw InputError(options_.scene, "the preview was stopped by a signal");
        for (const InputEvent& event : window_.take_events()) handle(event);
        if (!pending_.empty() && session_.idle()) press_pending();
        const double rests_s = rests_s_before_drawing();
        if (rests_s > 0) {
            session_.update();
            window_.wait(rests_s);
            continue;
        }
        if (script_) {
            for (const InputEvent& event : script_->before_frame(controls_)) handle(event);
        }
        session_.update();
        take_pictures();
        const Eigen::Vector2i size = window_.framebuffer_size();
        // While a script waits for a picture, frames of the window would only take the processor from it.
        const bool waits = script_ && script_->waits() && !session_.idle() && !session_.is_told();
        const bool scripted = script_ && !script_->finished() && !waits;
        const bool damaged = window_.take_damage() || size != drawn_px_;
        const bool tells = session_.is_told();
        if (size.minCoeff() > 0 && (damaged || scripted || tells || frames_to_draw_ > 0)) {
            drawn_px_ = size;
            frames_to_draw_ = std::max(0, frames_to_draw_ - 1);
            draw(damaged);
            if (script_) script_->after_frame(controls_);
        }
        window_.set_title(title());
        if (!quit_) window_.wait(idle_s());
    }
    if (options_.script.empty()) {
        save_window_settings({.size_px = drawn_px_, .panel_width = state_.layout.panel_width});
    }
}

void Preview::save_snapshot() {
    update_wishes();
    session_.settle();
    while (!pending_.empty() && !quit_) press_pending();
    session_.settle();
    window_.context().make_current();
    take_pictures();
    const PictureSize picture = displayed_picture();
    const Eigen::Vector2i own(static_cast<int>(picture.width), static_cast<int>(picture.height));
    drawn_px_ = options_.size.value_or(own);
    view_.begin(drawn_px_.x(), drawn_px_.y());
    view_.begin_part(view_.target().bounds());
    canvas_.draw(view_, {0, 0, drawn_px_.x(), drawn_px_.y()});
    write_png8(options_.snapshot, view_.shown(),
               {{"Software", fmt::format("matchlight {}\n{}", version, session_.scene().effective_toml)}});
}

PreviewResult Preview::result() const {
    return {.frame = session_.picture()->frame, .time_s = session_.picture()->time_s, .window_px = drawn_px_};
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
