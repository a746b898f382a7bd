// What mirrors and glossy surfaces see of the probe, by the form and size in which the GPU keeps it.
#include <cmath>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "gl/framebuffer.h"
#include "lighting/resample.h"
#include "render/environment.h"
#include "report/experiments.h"
#include "report/prefilter_reference.h"
#include "report/reflected_picture.h"

namespace matchlight {
namespace {

/// Draws what is reflected in every direction, and reads it back.
struct ReflectionChoice {
    std::string label;
    std::vector<Knob> knobs;
    EnvironmentSettings settings;
    double roughness = 0;
    bool sphere_map = false;
};

Candidate candidate_of(const SceneStage& stage, const ReflectionChoice& choice, int width) {
    const auto environment = std::make_shared<Environment>(stage.shaders, stage.probe, choice.settings);
    const auto picture = std::make_shared<ReflectedPicture>(width);
    Candidate candidate;
    candidate.point = {.level = choice.label, .knobs = choice.knobs, .precision = "16F"};
    candidate.work = [&stage, environment, picture, choice] {
        picture->draw(stage.shaders, *environment, choice.roughness, choice.sphere_map);
    };
    candidate.picture = [work = candidate.work, picture] {
        work();
        return picture->read();
    };
    return candidate;
}

/// Lookups of levels that an experiment does not look at.
constexpr int few_lookups = 10'000;

/// The frame's exposure, so that errors are seen as the frame's pictures show them.
ImageF exposed(ImageF light, const SceneStage& stage) {
    const double gain = std::exp2(stage.solved().exposure_ev.value_or(0));
    for (float& value : light.samples()) value = static_cast<float>(value * gain);
    return light;
}

void expose(Candidate& candidate, const SceneStage& stage) {
    candidate.picture = [&stage, picture = candidate.picture] { return exposed(picture(), stage); };
}

}  // namespace

std::optional<Experiment> reflection_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    constexpr int width = 1024;
    Experiment experiment;
    experiment.report.name = "reflection";
    experiment.report.what = fmt::format(
        "What a mirror shows of the probe in every direction ({}×{} pixels at the frame's exposure): looking it up.",
        width, width / 2);
    experiment.report.region = {0, 0, width, width / 2};
    const int rays = options.quick ? 4 : 8;
    experiment.report.reference =
        fmt::format("{0}×{0} directions a pixel of the probe itself, in double precision", rays);
    experiment.reference = exposed(reference_mirror_latlong(stage.probe, rays, width), stage);
    experiment.coarse_reference = exposed(reference_mirror_latlong(stage.probe, rays / 2, width), stage);
    for (const int face_size : {64, 128, 256, 512, 1024}) {
        // A probe gets no larger cube than it holds.
        if (face_size > 64 && face_size / 2 >= stage.probe.latlong.width() / 4) break;
        Candidate candidate = candidate_of(stage,
                                           {.label = fmt::format("cube {}", face_size),
                                            .knobs = {{"face_size", static_cast<double>(face_size)}},
                                            .settings = {.face_size = face_size, .lookups_per_level = few_lookups}},
                                           width);
        expose(candidate, stage);
        experiment.candidates.push_back(std::move(candidate));
    }
    for (const int size : {256, 512, 1024}) {
        Candidate candidate = candidate_of(stage,
                                           {.label = fmt::format("sphere map {}", size),
                                            .knobs = {{"sphere_map_size", static_cast<double>(size)}},
                                            .settings = {.sphere_map_size = size, .lookups_per_level = few_lookups},
                                            .sphere_map = true},
                                           width);
        expose(candidate, stage);
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

std::optional<Experiment> glossy_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    constexpr int width = 128;
    constexpr double roughness = 0.3;  // between levels, where most glossy materials are
    Experiment experiment;
    experiment.report.name = "glossy_reflection";
    experiment.report.what = fmt::format(
        "What a surface of roughness {} shows of the probe in every direction ({}×{} pixels at the frame's exposure): "
        "making its levels, once for the clip.",
        roughness, width, width / 2);
    experiment.report.unit = WorkUnit::clip;
    experiment.report.region = {0, 0, width, width / 2};
    const auto summed = [&](int height) {
        const ProbeLayout whole = layout_of_size(ProbeMapping::latlong, stage.probe.latlong.height());
        const Probe reduced = probe_from_image(stage.probe.latlong, whole, height);
        return exposed(reference_glossy_latlong(reduced, roughness, width), stage);
    };
    const int rows = std::min(options.quick ? 64 : 256, stage.probe.latlong.height());
    experiment.report.reference =
        fmt::format("the sum over {}×{} pixels of the probe under the lobe, in double precision", 2 * rows, rows);
    experiment.reference = summed(rows);
    experiment.coarse_reference = summed(rows / 2);
    for (const int lookups : {10'000, 100'000, 1'000'000, 3'000'000, 10'000'000}) {
        if (options.quick && lookups > 3'000'000) break;
        const EnvironmentSettings settings{.lookups_per_level = lookups};
        Candidate candidate =
            candidate_of(stage,
                         {.label = lookups >= 1'000'000 ? fmt::format("{} M lookups", lookups / 1'000'000)
                                                        : fmt::format("{} k lookups", lookups / 1000),
                          .knobs = {{"lookups_per_level", static_cast<double>(lookups)}},
                          .settings = settings,
                          .roughness = roughness},
                         width);
        expose(candidate, stage);
        candidate.work = [&stage, settings] { const Environment made(stage.shaders, stage.probe, settings); };
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

}  // namespace matchlight
