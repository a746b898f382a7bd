// Each effect under its own condition, summed.
#include "compositor/camera_effects.h"

#include "render/effects/bloom.h"

namespace matchlight {

CameraEffects::CameraEffects(ShaderLibrary& shaders, const EffectSettings& settings, const Quality& quality,
                             const Camera& camera)
    : shaders_(shaders), quality_(quality), camera_(camera) {
    set_settings(settings);
}

void CameraEffects::set_settings(const EffectSettings& settings) {
    const bool same_colors = settings.color_transform == settings_.color_transform;
    settings_ = settings;
    if (!same_colors) make_color_transform();
    std::vector<Glare> before = std::move(glares_);
    glares_.clear();
    if (settings.dazzle && settings.dazzle->glare) {
        add_glare_of(*settings.dazzle->glare, {BrightShare::objects, object_strength()}, "dazzle glare");
        if (settings.glare) add_glare_of(*settings.glare, {BrightShare::rest, 1}, "glare");
    } else if (settings.glare) {
        add_glare_of(*settings.glare, {BrightShare::all, object_strength()}, "glare");
    }
    // A kernel takes its time to make: one that is there already stays.
    for (Glare& glare : glares_) {
        for (Glare& old : before) {
            if (old.name == glare.name && old.settings == glare.settings) glare.wave = std::move(old.wave);
        }
    }
}

void CameraEffects::set_quality(const Quality& quality) {
    const bool same_table = quality.sensor == quality_.sensor;
    quality_ = quality;
    if (!same_table) make_color_transform();
    for (Glare& glare : glares_) glare.wave.reset();  // its kernel is of another quality
}

void CameraEffects::make_color_transform() {
    color_transform_.reset();
    if (const std::optional<ColorTransformSettings>& asked = settings_.color_transform)
        color_transform_.emplace(*asked, ColorTransformFiles::read(*asked), color_transform_knobs(quality_.sensor));
}

void CameraEffects::add_glare_of(const GlareSettings& settings, const StreakSource& source, const std::string& name) {
    const std::string dark = "no light is above the threshold of " + name;
    glares_.push_back({.settings = settings,
                       .source = source,
                       .name = name,
                       .streak_light = std::make_unique<GpuCondition>(dark),
                       .wave_light = std::make_unique<GpuCondition>(dark),
                       .wave = nullptr});
}

void CameraEffects::add_glare(RenderGraph& graph, const FrameLight& light, Glare& glare,
                              std::vector<SpillPart>& parts) {
    const GlareSettings& settings = glare.settings;
    if (settings.level != GlareLevel::diffraction) {
        const StreakKnobs knobs =
            streak_knobs(settings.level == GlareLevel::reference ? QualityLevel::reference : quality_.glare);
        parts.push_back({add_streaks(graph, shaders_, light, settings, knobs, glare.source, *glare.streak_light),
                         glare.streak_light.get()});
    }
    if (settings.level != GlareLevel::diffraction && settings.halo == 0) return;
    if (!glare.wave) {
        glare.wave = std::make_unique<WaveGlare>(shaders_, settings,
                                                 WaveGlareOptions{.name = glare.name + "/wave",
                                                                  .frame_width = camera_.width,
                                                                  .frame_height = camera_.height,
                                                                  .focal_px = camera_.fx,
                                                                  .knobs = wave_glare_knobs(quality_.glare)});
    }
    const WaveGlareSource source{light, glare.source.share, glare.source.object_strength};
    parts.push_back({add_wave_glare(graph, source, *glare.wave_light, *glare.wave), glare.wave_light.get()});
}

GraphTexture CameraEffects::add(RenderGraph& graph, const FrameLight& light) {
    explain(graph);
    if (!light.after) return {};
    std::vector<SpillPart> parts;
    if (settings_.bloom) {
        parts.push_back({add_bloom(graph, shaders_, light, *settings_.bloom,
                                   bloom_knobs(*settings_.bloom, quality_.bloom), object_strength(), bloom_light_),
                         &bloom_light_});
    }
    for (Glare& glare : glares_) add_glare(graph, light, glare, parts);
    return add_spill_sum(graph, shaders_, parts);
}

void CameraEffects::explain(RenderGraph& graph) const {
    if (!settings_.bloom) graph.leave_out("bloom", "the scene does not ask for it");
    if (glares_.empty()) graph.leave_out("glare", "the scene does not ask for it");
}

}  // namespace matchlight
