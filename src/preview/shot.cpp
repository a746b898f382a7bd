// Loads as render does, and remakes as little as a switch needs.
#include "preview/shot.h"

#include "compositor/budget.h"
#include "compositor/exposure_meter.h"
#include "compositor/surface_picture.h"
#include "scene/footage_options.h"
#include "tracking/scene_solve.h"

namespace matchlight {

namespace {

/// Nothing is solved or decoded anew where these stay.
bool same_clip(const Scene& a, const Scene& b) {
    return a.footage == b.footage && a.tags == b.tags && a.camera == b.camera && a.background == b.background;
}

bool is_metered(const Scene& scene) {
    return scene.effects.exposure && scene.effects.exposure->mode == ExposureMode::simulated;
}

}  // namespace

Shot::Shot(GlContext& context, const std::filesystem::path& scene_path, bool quiet, Warnings& warnings)
    : context_(context),
      quiet_(quiet),
      warnings_(warnings),
      scene_(load_scene(scene_path, warnings)),
      solve_(solve_of_scene(scene_, warnings)),
      frames_(std::make_unique<FrameCache>(open_frames(scene_, false, warnings))),
      level_(scene_level()) {}

ShotLevel Shot::scene_level() const {
    return {.level = scene_.quality, .budget = scene_.budget_ms.has_value()};
}

Scene Shot::drawn_scene() const {
    Scene scene = scene_;
    scene.quality = level_.level;
    if (!level_.budget) scene.budget_ms.reset();
    if (!level_.opaque_spheres) return scene;
    for (ObjectSettings& object : scene.objects) {
        object.sphere.opacity = 1;
        object.sphere.opacity_column.clear();
    }
    return scene;
}

void Shot::make_compositor() {
    const Scene scene = drawn_scene();
    compositor_.reset();  // its textures first: two sets may be more than the memory holds
    Solve solve = solve_;
    context_.make_current();
    meter_clip(solve, scene, context_, {.quiet = quiet_}, warnings_);
    const CompositorOptions options{
        .quality = scene.quality,
        .budget = budget_of_scene(scene, context_, warnings_),
        .gathered_surface = surface_picture_of_clip(scene, solve, {.quiet = quiet_}, warnings_)};
    compositor_ = std::make_unique<Compositor>(context_, scene, solve, options, warnings_);
    if (dragging_) compositor_->set_dragging(true);
    compositor_->watch(watched_pass_);
}

void Shot::set_level(const ShotLevel& level) {
    if (level == level_) return;
    level_ = level;
    compositor_.reset();
    free_.reset();
}

void Shot::set_scene(const Scene& scene) {
    const bool clip_stays = same_clip(scene, scene_);
    // What is metered of the clip depends on all that is drawn in it.
    const bool keeps = clip_stays && !is_metered(scene) && !is_metered(scene_);
    scene_ = scene;
    if (!clip_stays) {
        solve_ = solve_of_scene(scene_, warnings_);
        frames_ = std::make_unique<FrameCache>(open_frames(scene_, false, warnings_));
    }
    context_.make_current();
    std::unique_ptr<FreeShot> free = std::move(free_);
    if (clip_stays && free && free->set_scene(drawn_scene())) free_ = std::move(free);
    if (compositor_ == nullptr) return;
    // Of no use any more unless it takes the scene.
    std::unique_ptr<Compositor> compositor = std::move(compositor_);
    if (keeps && compositor->set_scene(drawn_scene())) compositor_ = std::move(compositor);
}

void Shot::set_dragging(bool dragging) {
    if (dragging == dragging_) return;
    dragging_ = dragging;
    if (compositor_ && !compositor_->set_dragging(dragging)) compositor_.reset();
    if (free_ && !free_->set_dragging(dragging)) free_.reset();
}

Image8 Shot::composited(const PlateFrame& plate) {
    if (!compositor_) make_compositor();
    return compositor_->composite(plate).rgb8();
}

Image8 Shot::seen_from(const CameraView& view, std::int64_t frame) {
    context_.make_current();
    if (!free_) free_ = std::make_unique<FreeShot>(context_, drawn_scene(), solve_, view, warnings_);
    return free_->picture(frame, view);
}

Image8 Shot::probe_seen(ProbeForm form, const PlateFrame& plate) {
    if (!scene_.probe) return {};
    if (read_probe_ != scene_.probe) {
        const ProbeSettings& settings = *scene_.probe;
        probe_ = placed(load_probe(settings.path, settings.mapping, warnings_), settings.placement);
        read_probe_ = settings;
    }
    ProbeLook look{.form = form, .width = solve_.camera.width, .height = solve_.camera.height};
    if (const SolvedFrame* frame = solve_.find(plate.index())) {
        const SolvedFrame* exposed = solve_.exposed_near(*frame);
        if (exposed != nullptr) look.exposure_ev = exposed->exposure_ev.value_or(0);
        if (frame->camera_from_world) look.world_from_camera = frame->camera_from_world->linear().transpose();
    }
    return probe_picture(probe_, look);
}

void Shot::watch(const std::string& pass) {
    watched_pass_ = pass;
    if (compositor_) compositor_->watch(pass);
}

std::optional<WatchedTexture> Shot::watched() const {
    return compositor_ ? compositor_->watched() : std::nullopt;
}

std::vector<PassReport> Shot::passes(const PlateFrame& plate) {
    if (!compositor_) make_compositor();
    compositor_->set_timed(true);
    compositor_->composite(plate);
    compositor_->set_timed(false);
    return compositor_->reports();
}

ShaderReload Shot::reload_shaders() {
    // Without a compositor (its shaders do not compile, say) a change of files is reason to try again.
    if (free_) free_->reload_shaders();
    return compositor_ ? compositor_->reload_shaders() : files_.reload_changed();
}

}  // namespace matchlight
