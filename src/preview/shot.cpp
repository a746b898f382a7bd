// Loads as render does, and remakes as little as a switch needs.
#include "preview/shot.h"

#include "compositor/budget.h"
#include "compositor/exposure_meter.h"
#include "compositor/surface_picture.h"
#include "scene/footage_options.h"
#include "tracking/scene_solve.h"

namespace matchlight {

namespace {

template <class Settings>
void switch_effect(std::optional<Settings>& effect, bool on) {
    if (!on) effect.reset();
    if (on && !effect) effect.emplace();
}

}  // namespace

EffectSettings switched_effects(const EffectSettings& of_scene, const ShotSwitches& switches) {
    EffectSettings effects = of_scene;
    switch_effect(effects.bloom, switches.bloom);
    switch_effect(effects.glare, switches.glare);
    if (!switches.dazzle) effects.dazzle = DazzleSettings{.strength = 0, .glare = {}};
    // Matched exposure is what holds without exposure control: the switch is between that and the simulated one.
    switch_effect(effects.exposure, switches.exposure);
    if (effects.exposure) effects.exposure->mode = ExposureMode::simulated;
    return effects;
}

Shot::Shot(GlContext& context, const std::filesystem::path& scene_path, bool quiet, Warnings& warnings)
    : context_(context),
      quiet_(quiet),
      warnings_(warnings),
      scene_(load_scene(scene_path, warnings)),
      solve_(solve_of_scene(scene_, warnings)),
      frames_(open_frames(scene_, false, warnings)),
      switches_(scene_switches()) {}

ShotSwitches Shot::scene_switches() const {
    const EffectSettings& effects = scene_.effects;
    return {.bloom = effects.bloom.has_value(),
            .glare = effects.glare.has_value(),
            .dazzle = true,
            .exposure = effects.exposure && effects.exposure->mode == ExposureMode::simulated,
            .shadow = scene_.surface.present && scene_.surface.shadow,
            .level = scene_.quality,
            .budget = scene_.budget_ms.has_value()};
}

void Shot::make_compositor() {
    Scene scene = scene_;
    scene.effects = switched_effects(scene_.effects, switches_);
    scene.surface.shadow = switches_.shadow;
    scene.quality = switches_.level;
    if (!switches_.budget) scene.budget_ms.reset();
    compositor_.reset();  // its textures first: two sets may be more than the memory holds
    Solve solve = solve_;
    context_.make_current();
    meter_clip(solve, scene, context_, {.quiet = quiet_}, warnings_);
    const CompositorOptions options{
        .quality = scene.quality,
        .budget = budget_of_scene(scene, context_, warnings_),
        .gathered_surface = surface_picture_of_clip(scene, solve, {.quiet = quiet_}, warnings_)};
    compositor_ = std::make_unique<Compositor>(context_, scene, solve, options, warnings_);
}

void Shot::set_switches(const ShotSwitches& switches) {
    const bool remake = switches.budget || switches.budget != switches_.budget || switches.shadow != switches_.shadow ||
                        switches.level != switches_.level || switches.exposure != switches_.exposure;
    switches_ = switches;
    if (remake) compositor_.reset();
    if (compositor_) compositor_->set_effects(switched_effects(scene_.effects, switches_));
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
