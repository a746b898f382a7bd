// Streak glare by level and knob: exact exponentials as its reference, the classic diagonals against their own.
#include <functional>

#include <fmt/format.h>

#include "render/effects/streaks.h"
#include "report/spill_experiment.h"
#include "report/streaks_reference.h"

namespace matchlight {
namespace {

double object_strength_of(const SceneStage& stage) {
    return stage.scene.effects.dazzle ? stage.scene.effects.dazzle->strength : 1;
}

SpillWay way_of(const SceneStage& stage, const std::string& label, const GlareSettings& settings,
                const StreakKnobs& knobs) {
    return {.label = label,
            .knobs = {{"largest_scale", static_cast<double>(knobs.largest_scale)},
                      {"sigma_texels", knobs.sigma_texels},
                      {"cut_sigmas", knobs.cut_sigmas},
                      {"directions", static_cast<double>(settings.directions)},
                      {"passes", static_cast<double>(settings.passes)}},
            .precision = knobs.full_float ? "32F" : "16F",
            .add = [&stage, settings, knobs](RenderGraph& graph, const FrameLight& light, GpuCondition& bright) {
                return add_streaks(graph, stage.shaders, light, settings, knobs,
                                   {.object_strength = object_strength_of(stage)}, bright);
            }};
}

/// The scene's glare where it has streaks, or the default asked for by name.
std::optional<GlareSettings> settings_of(const SceneStage& stage, const ExperimentOptions& options, GlareLevel level) {
    const std::optional<GlareSettings>& asked = stage.scene.effects.glare;
    if (!options.by_name && (!asked || asked->level == GlareLevel::diffraction)) return std::nullopt;
    GlareSettings settings = asked.value_or(GlareSettings{});
    settings.level = level;
    return settings;
}

}  // namespace

std::optional<Experiment> streaks_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const std::optional<GlareSettings> settings = settings_of(stage, options, GlareLevel::streaks);
    if (!settings) return std::nullopt;
    SpillExperiment spill{
        .name = "streaks",
        .what = fmt::format("Bright light drawn out in {} directions: all of the effect, bright pass included.",
                            settings->directions),
        .reference_words =
            "the exponential's closed form at every pixel to 6 standard deviations across, in double precision",
        .ways = {},
        .dark_below = settings->threshold * (1 - settings->knee),
        .reference = [&stage, settings = *settings](const FrameLightImages& light, bool with_half) {
            const ImageD bright = reference_bright_light(
                light.after, light.before, streak_light(settings, BrightShare::all, object_strength_of(stage)));
            return reference_streaks(bright, settings, with_half ? 3 : 6);
        }};
    for (const auto& [name, level] : quality_levels) {
        if (level == QualityLevel::final_) spill.final_way = spill.ways.size();
        spill.ways.push_back(way_of(stage, std::string(name), *settings, streak_knobs(level)));
    }
    if (options.quick) return make_experiment(stage, spill);
    const auto add = [&](const std::string& label, const std::function<void(StreakKnobs&)>& change) {
        StreakKnobs knobs = streak_knobs(QualityLevel::final_);
        change(knobs);
        spill.ways.push_back(way_of(stage, label, *settings, knobs));
    };
    for (const int scale : {1, 2, 4, 8}) {
        add(fmt::format("scale {}", scale), [=](StreakKnobs& knobs) { knobs.largest_scale = scale; });
    }
    for (const double sigma : {0.25, 1.0, 2.0}) {
        add(fmt::format("sigma {}", sigma), [=](StreakKnobs& knobs) { knobs.sigma_texels = sigma; });
    }
    add("cut 2", [](StreakKnobs& knobs) { knobs.cut_sigmas = 2; });
    add("32F", [](StreakKnobs& knobs) { knobs.full_float = true; });
    return make_experiment(stage, spill);
}

std::optional<Experiment> classic_streaks_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const std::optional<GlareSettings> settings = settings_of(stage, options, GlareLevel::classic);
    if (!settings) return std::nullopt;
    SpillExperiment spill{
        .name = "classic_streaks",
        .what = "The study's four diagonals on a square of 128 texels: all of the effect, bright pass included.",
        .reference_words = "the same square and taps in double precision",
        .ways = {},
        .dark_below = settings->threshold * (1 - settings->knee),
        .reference = [&stage, settings = *settings](const FrameLightImages& light, bool with_half) {
            if (with_half) return ImageD();  // nothing in it is cut
            const ImageD bright = reference_bright_light(
                light.after, light.before, streak_light(settings, BrightShare::all, object_strength_of(stage)));
            return reference_classic_streaks(bright, settings);
        }};
    spill.ways.push_back(way_of(stage, "16F", *settings, streak_knobs(QualityLevel::final_)));
    StreakKnobs full_float = streak_knobs(QualityLevel::final_);
    full_float.full_float = true;
    spill.ways.push_back(way_of(stage, "32F", *settings, full_float));
    return make_experiment(stage, spill);
}

}  // namespace matchlight
