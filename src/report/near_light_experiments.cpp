// What objects mirror of what is near, and what light bounces between them: by level and by rays.
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "report/experiments.h"

namespace matchlight {
namespace {

struct NearLightChoice {
    std::string label;
    std::vector<Knob> knobs;
    Quality quality;
};

ImageF picture_with_rays(const SceneStage& stage, const Quality& quality, const Region& region) {
    const auto compositor = stage.compositor_with_rays(quality, true);
    const CompositedFrame frame = compositor->composite(*stage.plate);
    return cropped(frame.layers->beauty, region.moved(-frame.layers->region.x, -frame.layers->region.y));
}

/// At the samples of the level final, of which each is a part of the reference, too.
Quality with_reflection(const ReflectionSettings& reflection) {
    Quality quality = quality_of(QualityLevel::final_);
    quality.reflection = reflection;
    return quality;
}

Quality with_bounce(const BounceLightSettings& bounce) {
    Quality quality = quality_of(QualityLevel::final_);
    quality.bounce = bounce;
    return quality;
}

/// The frame's part that is measured; nullopt where nothing virtual is in view.
std::optional<Region> begin(Experiment& experiment, const SceneStage& stage) {
    const auto compositor = stage.compositor(quality_of(QualityLevel::draft), true);
    const CompositedFrame frame = compositor->composite(*stage.plate);
    if (!frame.layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return std::nullopt;
    }
    experiment.stopwatch = Stopwatch::wall;
    experiment.report.region = frame.layers->region;
    return frame.layers->region;
}

Candidate candidate_of(const SceneStage& stage, const NearLightChoice& choice, const Region& region) {
    Candidate candidate;
    candidate.point = {.level = choice.label, .knobs = choice.knobs, .precision = "32F"};
    candidate.picture = [&stage, quality = choice.quality, region] {
        return picture_with_rays(stage, quality, region);
    };
    return candidate;
}

}  // namespace

std::optional<Experiment> near_reflection_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    Experiment experiment;
    experiment.report.name = "near_reflection";
    experiment.report.what =
        "What objects mirror of the surface, of each other and of themselves: the whole frame is timed.";
    experiment.report.unit = WorkUnit::frame;
    const std::optional<Region> region = begin(experiment, stage);
    if (!region) return experiment;
    const int rays = options.quick ? 4 : 64;
    const auto converged = [&](int lobe_rays) {
        return picture_with_rays(stage, with_reflection({.lobe_rays = lobe_rays, .bounces = 8}), *region);
    };
    experiment.report.reference =
        fmt::format("{} rays a sample along each lobe, through 8 mirrors, in single precision", rays);
    experiment.reference = converged(rays);
    experiment.coarse_reference = converged(rays / 2);
    std::vector<NearLightChoice> choices{
        {"environment (draft)", {}, with_reflection({.level = ReflectionLevel::environment})},
        {"plane (preview)", {}, with_reflection({.level = ReflectionLevel::plane})}};
    for (const int lobe_rays : {1, 2, 4, 8}) {
        if (options.quick && lobe_rays > 2) break;
        choices.push_back(
            {fmt::format("{} rays{}", lobe_rays, lobe_rays == ReflectionSettings{}.lobe_rays ? " (final)" : ""),
             {{"lobe_rays", static_cast<double>(lobe_rays)}},
             with_reflection({.lobe_rays = lobe_rays})});
    }
    for (const NearLightChoice& choice : choices) {
        Candidate candidate = candidate_of(stage, choice, *region);
        const std::shared_ptr<Compositor> compositor = stage.compositor_with_rays(choice.quality, false);
        candidate.work = [&stage, compositor] { compositor->composite(*stage.plate); };
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

std::optional<Experiment> bounce_light_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    Experiment experiment;
    experiment.report.name = "bounce_light";
    experiment.report.what =
        "Light that bounces between objects and to the surface: making all of the clip's light with it, once for the "
        "clip. Errors are of the frame.";
    experiment.report.unit = WorkUnit::clip;
    const std::optional<Region> region = begin(experiment, stage);
    if (!region) return experiment;
    const int rays = options.quick ? 32 : 1024;
    const auto converged = [&](int count) {
        return picture_with_rays(
            stage, with_bounce({.rays = count, .surface_rays = 2 * count, .bounces = 6, .surface_points = 192}),
            *region);
    };
    experiment.report.reference =
        fmt::format("{} rays a vertex, {} a point of the surface, in single precision", rays, 2 * rays);
    experiment.reference = converged(rays);
    experiment.coarse_reference = converged(rays / 2);
    std::vector<NearLightChoice> choices{{"none (draft, preview)", {}, with_bounce({.rays = 0})}};
    for (const int count : {4, 16, 64, 256}) {
        if (options.quick && count > 16) break;
        choices.push_back({fmt::format("{} rays{}", count, count == BounceLightSettings{}.rays ? " (final)" : ""),
                           {{"rays", static_cast<double>(count)}, {"surface_rays", static_cast<double>(4 * count)}},
                           with_bounce({.rays = count, .surface_rays = 4 * count})});
    }
    for (const NearLightChoice& choice : choices) {
        Candidate candidate = candidate_of(stage, choice, *region);
        candidate.work = [&stage, quality = choice.quality] { stage.compositor_with_rays(quality, false); };
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

}  // namespace matchlight
