// Diffraction and the lenticular halo by level and knob, against double-precision convolution at every pixel.
#include <functional>
#include <memory>

#include <fmt/format.h>

#include "render/effects/wave_glare.h"
#include "report/diffraction_reference.h"
#include "report/halo_reference.h"
#include "report/spill_experiment.h"

namespace matchlight {
namespace {

double object_strength_of(const SceneStage& stage) {
    return stage.scene.effects.dazzle ? stage.scene.effects.dazzle->strength : 1;
}

SpillWay way_of(const SceneStage& stage, const std::string& label, const GlareSettings& settings,
                const WaveGlareKnobs& knobs) {
    const auto glare = std::make_shared<std::unique_ptr<WaveGlare>>();  // made when first drawn
    return {.label = label,
            .knobs = {{"most_side", static_cast<double>(knobs.most_side)},
                      {"wavelengths", static_cast<double>(knobs.diffraction.wavelengths)},
                      {"aperture_side", static_cast<double>(knobs.diffraction.aperture_side)}},
            .precision = knobs.full_float ? "32F" : "16F",
            .add = [&stage, settings, knobs, glare](RenderGraph& graph, const FrameLight& light, GpuCondition& bright) {
                if (!*glare) {
                    *glare = std::make_unique<WaveGlare>(stage.shaders, settings,
                                                         WaveGlareOptions{.frame_width = stage.plate->format().width,
                                                                          .frame_height = stage.plate->format().height,
                                                                          .focal_px = stage.solve.camera.fx,
                                                                          .knobs = knobs});
                }
                return add_wave_glare(graph, {.light = light, .object_strength = object_strength_of(stage)}, bright,
                                      **glare);
            }};
}

ImageD reference_of(const SceneStage& stage, const GlareSettings& settings, const FrameLightImages& light,
                    bool with_half) {
    const ImageD bright = reference_bright_light(
        light.after, light.before, wave_glare_light(settings, BrightShare::all, object_strength_of(stage)));
    DiffractionQuality quality = converged_diffraction;
    HaloReferenceOptions halo{.focal_px = stage.solve.camera.fx, .strength = settings.halo};
    if (with_half) {
        quality.wavelengths /= 2;
        quality.samples /= 2;
        halo.wavelengths /= 2;
        halo.points /= 2;
    }
    ImageD added = reference_diffraction(bright, settings, quality);
    if (settings.halo > 0) {
        const ImageD rings = reference_halo(bright, halo);
        for (std::size_t i = 0; i < added.samples().size(); ++i) added.samples()[i] += rings.samples()[i];
    }
    return added;
}

}  // namespace

std::optional<Experiment> diffraction_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const std::optional<GlareSettings>& asked = stage.scene.effects.glare;
    if (!options.by_name && !(asked && asked->level == GlareLevel::diffraction)) return std::nullopt;
    GlareSettings settings = asked.value_or(GlareSettings{});
    settings.level = GlareLevel::diffraction;
    SpillExperiment spill{
        .name = "diffraction",
        .what = "The aperture's diffraction pattern around bright light: all of the effect, bright pass included.",
        .reference_words = "128 wavelengths of an aperture of 2048 texels, FFTW at every pixel in double precision",
        .ways = {},
        .dark_below = settings.threshold * (1 - settings.knee),
        .reference = [&stage, settings](const FrameLightImages& light, bool with_half) {
            return reference_of(stage, settings, light, with_half);
        }};
    for (const auto& [name, level] : quality_levels) {
        if (level == QualityLevel::final_) spill.final_way = spill.ways.size();
        spill.ways.push_back(way_of(stage, std::string(name), settings, wave_glare_knobs(level)));
    }
    if (options.quick) return make_experiment(stage, spill);
    const auto add = [&](const std::string& label, const std::function<void(WaveGlareKnobs&)>& change) {
        WaveGlareKnobs knobs = wave_glare_knobs(QualityLevel::final_);
        change(knobs);
        spill.ways.push_back(way_of(stage, label, settings, knobs));
    };
    for (const int side : {128, 256, 512, 2048}) {
        add(fmt::format("side {}", side), [=](WaveGlareKnobs& knobs) { knobs.most_side = side; });
    }
    for (const int wavelengths : {8, 16, 64}) {
        add(fmt::format("{} wavelengths", wavelengths),
            [=](WaveGlareKnobs& knobs) { knobs.diffraction.wavelengths = wavelengths; });
    }
    for (const int side : {256, 512, 2048}) {
        add(fmt::format("aperture {}", side), [=](WaveGlareKnobs& knobs) { knobs.diffraction.aperture_side = side; });
    }
    add("32F", [](WaveGlareKnobs& knobs) { knobs.full_float = true; });
    return make_experiment(stage, spill);
}

}  // namespace matchlight
