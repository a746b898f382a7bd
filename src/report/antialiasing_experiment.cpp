// Edges and shading of the virtual layer by the samples that a plate pixel gets.
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/memory.h"
#include "report/experiments.h"

namespace matchlight {
namespace {

struct SampleChoice {
    std::string label;
    int supersampling, samples;
};

Quality with_samples(int supersampling, int samples) {
    Quality quality = quality_of(QualityLevel::final_);
    quality.supersampling = supersampling;
    quality.samples = samples;
    return quality;
}

ImageF picture_of(const SceneStage& stage, const Quality& quality, const Region& region) {
    const auto compositor = stage.compositor(quality, true);
    const CompositedFrame frame = compositor->composite(*stage.plate);
    return cropped(frame.layers->beauty, region.moved(-frame.layers->region.x, -frame.layers->region.y));
}

}  // namespace

std::optional<Experiment> antialiasing_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    Experiment experiment;
    experiment.report.name = "antialiasing";
    experiment.report.what = "The virtual layer by pixels and samples a plate pixel: the whole frame is timed.";
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const CompositedFrame frame = stage.compositor(quality_of(QualityLevel::final_), true)->composite(*stage.plate);
    if (!frame.layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    const Region region = frame.layers->region;
    experiment.report.region = region;

    // Colour and depth of 8 × 8 layer pixels a plate pixel, with four samples each where a quarter of the free memory
    // holds them.
    constexpr int reference_side = 8;
    constexpr double bytes_a_sample = 8 + 4;
    const double sample_bytes =
        bytes_a_sample * reference_side * reference_side * region.width * static_cast<double>(region.height);
    const bool multisampled = 4 * 5 * sample_bytes < static_cast<double>(available_memory_bytes());
    const int reference_samples = multisampled ? 4 : 1;
    experiment.report.reference =
        fmt::format("{0}×{0} pixels of {1} samples a plate pixel", reference_side, reference_samples);
    experiment.reference = picture_of(stage, with_samples(reference_side, reference_samples), region);
    experiment.coarse_reference = picture_of(stage, with_samples(reference_side / 2, reference_samples), region);

    std::vector<SampleChoice> choices;
    for (const auto& [name, level] : quality_levels) {
        const Quality quality = quality_of(level);
        // Preview has draft's samples.
        if (level == QualityLevel::preview) continue;
        choices.push_back({level == QualityLevel::draft ? "draft, preview" : std::string(name), quality.supersampling,
                           quality.samples});
    }
    choices.push_back({"1×1, 4 samples", 1, 4});
    if (!options.quick) {
        choices.push_back({"2×2, 4 samples", 2, 4});
        choices.push_back({"3×3", 3, 1});
        choices.push_back({"4×4", 4, 1});
    }
    for (const SampleChoice& choice : choices) {
        const Quality quality = with_samples(choice.supersampling, choice.samples);
        Candidate candidate;
        candidate.point = {.level = choice.label,
                           .knobs = {{"supersampling", static_cast<double>(choice.supersampling)},
                                     {"samples", static_cast<double>(choice.samples)}},
                           .precision = "16F"};
        candidate.picture = [&stage, quality, region] { return picture_of(stage, quality, region); };
        const std::shared_ptr<Compositor> compositor = stage.compositor(quality, false);
        candidate.work = [&stage, compositor] { compositor->composite(*stage.plate); };
        if (choice.label == "final") {
            Scene away = stage.scene;
            // Behind every camera that looks at the surface, and casting nothing on it.
            for (ObjectSettings& object : away.objects) {
                object.translate_m.z() -= 1e4;
                object.casts_shadow = false;
            }
            const std::shared_ptr<Compositor> nothing = stage.compositor(away, quality, false);
            experiment.left_out = LeftOutTrial{.condition = "no object is in view",
                                               .drawn = candidate.work,
                                               .skipped = [&stage, nothing] { nothing->composite(*stage.plate); },
                                               .code_difference =
                                                   [&stage, nothing] {
                                                       const PlateFormat& format = stage.plate->format();
                                                       return largest_code_difference(
                                                           stage.plate->rgb8({0, 0, format.width, format.height}),
                                                           nothing->composite(*stage.plate).rgb8());
                                                   }};
        }
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

}  // namespace matchlight
