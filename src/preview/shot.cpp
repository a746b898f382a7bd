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
}

void Shot::set_level(const ShotLevel& level) {
    if (level == level_) return;
    level_ = level;
    compositor_.reset();
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
    if (compositor_ == nullptr) return;
    context_.make_current();
    // Of no use any more unless it takes the scene.
    std::unique_ptr<Compositor> compositor = std::move(compositor_);
    if (keeps && compositor->set_scene(drawn_scene())) compositor_ = std::move(compositor);
}

void Shot::set_dragging(bool dragging) {
    if (dragging == dragging_) return;
    dragging_ = dragging;
    if (compositor_ && !compositor_->set_dragging(dragging)) compositor_.reset();
}

Image8 Shot::composited(const PlateFrame& plate) {
    if (!compositor_) make_compositor();
    return compositor_->composite(plate).rgb8();
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
    return compositor_ ? compositor_->reload_shaders() : files_.reload_changed();
}

}  // namespace matchlight
