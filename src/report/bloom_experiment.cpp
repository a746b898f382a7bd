// Bloom by level and knob: the mixture of Gaussians against its own reference, the classic squares against theirs.
#include <fmt/format.h>

#include "render/effects/bloom.h"
#include "report/bloom_reference.h"
#include "report/spill_experiment.h"

namespace matchlight {
namespace {

double object_strength_of(const SceneStage& stage) {
    return stage.scene.effects.dazzle ? stage.scene.effects.dazzle->strength : 1;
}

SpillWay way_of(const SceneStage& stage, const std::string& label, const BloomSettings& settings,
                const BloomKnobs& knobs) {
    return {.label = label,
            .knobs = {{"largest_scale", static_cast<double>(knobs.largest_scale)},
                      {"sigma_texels", knobs.sigma_texels},
                      {"cut_sigmas", knobs.cut_sigmas},
                      {"gaussians", static_cast<double>(knobs.gaussians)}},
            .precision = knobs.full_float ? "32F" : "16F",
            .add = [&stage, settings, knobs](RenderGraph& graph, const FrameLight& light, GpuCondition& bright) {
                return add_bloom(graph, stage.shaders, light, settings, knobs, object_strength_of(stage), bright);
            }};
}

std::optional<BloomSettings> settings_of(const SceneStage& stage, const ExperimentOptions& options) {
    if (stage.scene.effects.bloom) return stage.scene.effects.bloom;
    return options.by_name ? std::optional<BloomSettings>(BloomSettings{}) : std::nullopt;
}

}  // namespace

std::optional<Experiment> bloom_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const std::optional<BloomSettings> settings = settings_of(stage, options);
    if (!settings) return std::nullopt;
    BloomSettings pyramid = *settings, classic = *settings;
    pyramid.level = BloomLevel::pyramid;
    classic.level = BloomLevel::classic;
    const double cut = options.quick ? 6 : 12;
    SpillExperiment spill{
        .name = "bloom",
        .what =
            "Bright light spreads around where it is: all of the effect, bright pass included. The point classic is "
            "another model: its distance is that of the model.",
        .reference_words =
            fmt::format("five Gaussians to {:g} standard deviations at every pixel, in double precision", cut),
        .ways = {},
        .dark_below = pyramid.threshold * (1 - pyramid.knee),
        .reference = [&stage, pyramid, cut](const FrameLightImages& light, bool with_half) {
            const ImageD bright =
                reference_bright_light(light.after, light.before, bloom_light(pyramid, object_strength_of(stage)));
            return reference_bloom(bright, pyramid, with_half ? cut / 2 : cut);
        }};
    for (const auto& [name, level] : quality_levels) {
        if (level == QualityLevel::final_) spill.final_way = spill.ways.size();
        spill.ways.push_back(way_of(stage, std::string(name), pyramid, bloom_knobs(pyramid, level)));
    }
    spill.ways.push_back(way_of(stage, "classic", classic, bloom_knobs(classic, QualityLevel::final_)));
    if (!options.quick) {
        const BloomKnobs final_knobs = bloom_knobs(pyramid, QualityLevel::final_);
        const auto add = [&](const std::string& label, const auto& change) {
            BloomKnobs knobs = final_knobs;
            change(knobs);
            spill.ways.push_back(way_of(stage, label, pyramid, knobs));
        };
        for (const int scale : {1, 2, 4, 8}) {
            add(fmt::format("scale {}", scale), [=](BloomKnobs& knobs) { knobs.largest_scale = scale; });
        }
        for (const double sigma : {0.8, 1.6, 2.4}) {
            add(fmt::format("sigma {}", sigma), [=](BloomKnobs& knobs) { knobs.sigma_texels = sigma; });
        }
        for (const double sigmas : {2.0, 4.0}) {
            add(fmt::format("cut {:g}", sigmas), [=](BloomKnobs& knobs) { knobs.cut_sigmas = sigmas; });
        }
        for (const int gaussians : {3, 4}) {
            add(fmt::format("{} Gaussians", gaussians), [=](BloomKnobs& knobs) { knobs.gaussians = gaussians; });
        }
        add("32F", [](BloomKnobs& knobs) { knobs.full_float = true; });
    }
    return make_experiment(stage, spill);
}

std::optional<Experiment> classic_bloom_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<BloomSettings> settings = settings_of(stage, options);
    if (!settings) return std::nullopt;
    settings->level = BloomLevel::classic;
    const BloomSettings classic = *settings;
    const double cut = options.quick ? 6 : 12;
    SpillExperiment spill{
        .name = "classic_bloom",
        .what = "The study's chain of squares of 512, 256 and 64 texels: all of the effect, bright pass included.",
        .reference_words =
            fmt::format("the same squares in double precision, Gaussians to {:g} standard deviations", cut),
        .ways = {},
        .dark_below = classic.threshold * (1 - classic.knee),
        .reference = [&stage, classic, cut](const FrameLightImages& light, bool with_half) {
            const ImageD bright =
                reference_bright_light(light.after, light.before, bloom_light(classic, object_strength_of(stage)));
            return reference_classic_bloom(bright, classic, with_half ? cut / 2 : cut);
        }};
    const BloomKnobs final_knobs = bloom_knobs(classic, QualityLevel::final_);
    for (const double sigmas : {2.0, 3.0, 4.0}) {
        BloomKnobs knobs = final_knobs;
        knobs.cut_sigmas = sigmas;
        if (sigmas == final_knobs.cut_sigmas) spill.final_way = spill.ways.size();
        spill.ways.push_back(way_of(stage, fmt::format("cut {:g}", sigmas), classic, knobs));
    }
    BloomKnobs full_float = final_knobs;
    full_float.full_float = true;
    spill.ways.push_back(way_of(stage, "32F", classic, full_float));
    return make_experiment(stage, spill);
}

}  // namespace matchlight
