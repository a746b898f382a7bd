// Near light against double precision, on scenes small enough for it: error over effort.
#include <cmath>
#include <functional>
#include <initializer_list>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "report/experiments.h"
#include "report/near_light_trial.h"

namespace matchlight {
namespace {

struct TrialChoice {
    int count = 1;
    bool is_final = false;
    Quality quality;
};

struct TrialLine {
    const char* name;
    const char* what;
    const char* unit = "rays";
    NearLightSetup setup;
    std::vector<TrialChoice> choices;
};

/// Absent from quick reports that do not ask for it: the scene has no part in it.
std::optional<Experiment> experiment_of(const SceneStage& stage, const TrialLine& line,
                                        const ExperimentOptions& options) {
    if (options.quick && !options.by_name) return std::nullopt;
    const auto trial = std::make_shared<NearLightTrial>(stage.context, line.setup);
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.name = line.name;
    report.what = line.what;
    report.region = {0, 0, trial->width(), trial->height()};
    experiment.stopwatch = Stopwatch::wall;
    const int strata = options.quick ? 24 : 96;
    report.reference = fmt::format("{} rays a pixel in double precision", strata * strata);
    experiment.reference = trial->reference(strata);
    // Half as many rays.
    experiment.coarse_reference = trial->reference(static_cast<int>(std::lround(strata * std::sqrt(0.5))));
    for (const TrialChoice& choice : line.choices) {
        Candidate candidate;
        candidate.point = {.level = fmt::format("{} {}{}", choice.count, line.unit, choice.is_final ? " (final)" : ""),
                           .knobs = {{line.unit, static_cast<double>(choice.count)}},
                           .precision = "32F"};
        candidate.picture = [trial, quality = choice.quality] { return trial->drawn(quality); };
        candidate.work = [trial, quality = choice.quality] { trial->drawn(quality); };
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

/// The level final, with more or less of one thing.
std::vector<TrialChoice> choices_of(std::initializer_list<int> counts, int usual,
                                    const std::function<void(Quality&, int)>& set) {
    std::vector<TrialChoice> choices;
    for (const int count : counts) {
        Quality quality = quality_of(QualityLevel::final_);
        set(quality, count);
        choices.push_back({count, count == usual, quality});
    }
    return choices;
}

constexpr double glossy = 0.2;

}  // namespace

std::optional<Experiment> mirrored_lamp_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const auto set = [](Quality& quality, int rays) {
        quality.bounce.rays = 0;
        quality.reflection.lobe_rays = rays;
    };
    return experiment_of(stage,
                         {.name = "mirrored_lamp",
                          .what = "A lamp in a slab of glossy metal, drawn from nothing, against double precision.",
                          .setup = {.kind = NearLightKind::mirrored_by_object, .roughness = glossy},
                          .choices = choices_of({1, 2, 4, 8}, ReflectionSettings{}.lobe_rays, set)},
                         options);
}

std::optional<Experiment> table_reflection_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const auto set = [](Quality& quality, int rays) {
        quality.bounce.rays = 0;
        quality.reflection.surface_rays = rays;
    };
    return experiment_of(stage,
                         {.name = "table_reflection",
                          .what = "A lamp in a glossy real surface, drawn from nothing, against double precision.",
                          .setup = {.kind = NearLightKind::mirrored_by_surface, .roughness = glossy},
                          .choices = choices_of({1, 2, 4, 8, 16, 64}, ReflectionSettings{}.surface_rays, set)},
                         options);
}

std::optional<Experiment> lamp_on_table_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const auto set = [](Quality& quality, int rays) { quality.bounce.surface_rays = rays; };
    return experiment_of(
        stage,
        {.name = "lamp_on_table",
         .what = "A lamp that shines on the real surface, with its shadow, drawn from nothing, against "
                 "double precision.",
         .setup = {.kind = NearLightKind::bounced_to_surface},
         .choices = choices_of({16, 64, 256, 1024}, BounceLightSettings{}.surface_rays, set)},
        options);
}

std::optional<Experiment> holdout_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const auto set = [](Quality& quality, int directions) {
        quality.bounce.rays = 0;
        quality.object_shadow.directions = directions;
    };
    return experiment_of(
        stage,
        {.name = "holdout_shadow",
         .what = "The shadow of a black box on a real slab (`holdout = true`), against double precision.",
         .unit = "directions",
         .setup = {.kind = NearLightKind::shadow_on_holdout},
         .choices = choices_of({16, 64, 256}, ObjectShadowSettings{}.directions, set)},
        options);
}

}  // namespace matchlight
