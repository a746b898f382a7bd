// Analytic lights, classic shading and depth cueing against double precision, on scenes small enough for it.
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "compositor/quality.h"
#include "report/experiments.h"
#include "report/lamp_trial.h"

namespace matchlight {
namespace {

struct LampChoice {
    std::string level;
    std::vector<Knob> knobs;
    LampTrialSetup setup;
    LampQuality quality;
};

struct LampLine {
    const char* name;
    const char* what;
};

/// All of one reference, of the first choice's setup. Absent from quick reports that do not ask for it.
std::optional<Experiment> experiment_of(const SceneStage& stage, const LampLine& line,
                                        const std::vector<LampChoice>& choices, const ExperimentOptions& options) {
    if (options.quick && !options.by_name) return std::nullopt;
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.name = line.name;
    report.what = line.what;
    report.region = {0, 0, LampTrial::size_px, LampTrial::size_px};
    experiment.stopwatch = Stopwatch::wall;
    const int rays = options.quick ? 400 : 4000;
    report.reference = fmt::format("the lamp as {} rays a pixel in double precision", rays);
    const LampTrial of_reference(stage.shaders, choices.front().setup);
    experiment.reference = of_reference.reference(rays);
    experiment.coarse_reference = of_reference.reference(rays / 2);
    for (const LampChoice& choice : choices) {
        const auto trial = std::make_shared<LampTrial>(stage.shaders, choice.setup);
        Candidate candidate;
        candidate.point = {.level = choice.level, .knobs = choice.knobs, .precision = "32F"};
        candidate.picture = [trial, quality = choice.quality] { return trial->drawn(quality); };
        candidate.work = [trial, quality = choice.quality] { trial->drawn(quality); };
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

LampSettings soft_lamp() {
    return {.type = LampType::point, .intensity = 0.2, .position_m = {0.1, 0.05, 0.3}, .radius_m = 0.03};
}

}  // namespace

std::optional<Experiment> lamp_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::vector<LampChoice> choices;
    const LampTrialSetup setup{.lamp = soft_lamp(), .ambient = 0.1};
    for (const QualityLevel level :
         {QualityLevel::draft, QualityLevel::preview, QualityLevel::final_, QualityLevel::reference}) {
        LampQuality quality = lamp_quality_of(level);
        choices.push_back(
            {std::string(name_of(level)),
             {{"taps", static_cast<double>(quality.taps)}, {"texels", static_cast<double>(quality.resolution)}},
             setup,
             quality});
    }
    return experiment_of(stage,
                         {.name = "lamp_shadow",
                          .what = "The soft shadow of a ball under a lamp of some size, by a map, drawn from nothing."},
                         choices, options);
}

std::optional<Experiment> classic_shading_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    LampSettings lamp = soft_lamp();
    lamp.radius_m = 0;
    lamp.casts_shadow = false;
    const LampTrialSetup setup{
        .lamp = lamp, .ambient = 0.1, .shading = {.model = ShadingModel::phong}, .measures_ball = true};
    return experiment_of(
        stage, {.name = "classic_shading", .what = "A ball by Phong's equation under one lamp, drawn from nothing."},
        {{"phong", {}, setup, {}}}, options);
}

std::optional<Experiment> depth_cue_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    LampSettings lamp = soft_lamp();
    lamp.radius_m = 0;
    lamp.casts_shadow = false;
    const LampTrialSetup setup{.lamp = lamp,
                               .ambient = 0.1,
                               .shading = {.model = ShadingModel::phong},
                               .depth_cue = DepthCueSettings{.near_m = 4.87, .far_m = 4.93, .color = {0.1, 0.2, 0.3}},
                               .measures_ball = true};
    return experiment_of(stage,
                         {.name = "depth_cue", .what = "A ball that fades with its distance, drawn from nothing."},
                         {{"linear", {}, setup, {}}}, options);
}

}  // namespace matchlight
