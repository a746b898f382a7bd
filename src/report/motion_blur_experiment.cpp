// Motion blur by its levels, against the scene drawn at many times.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "report/experiments.h"

namespace matchlight {
namespace {

struct MotionChoice {
    std::string level;
    std::vector<Knob> knobs;
    MotionBlurSettings settings;
    QualityLevel quality = QualityLevel::final_;
};

Scene with_motion_blur(const SceneStage& stage, const MotionBlurSettings& settings) {
    Scene scene = stage.scene;
    scene.effects.motion_blur = settings;
    return scene;
}

Quality with_gather_of(QualityLevel level) {
    Quality quality = quality_of(QualityLevel::final_);
    quality.motion_blur = level;
    return quality;
}

MotionBlurSettings drawn_at(const MotionBlurSettings& settings, int sub_frames) {
    MotionBlurSettings changed = settings;
    changed.level = MotionBlurLevel::sub_frames;
    changed.sub_frames = sub_frames;
    return changed;
}

ImageF picture_of(const SceneStage& stage, const MotionBlurSettings& settings, QualityLevel level,
                  const Region& region) {
    const auto compositor = stage.compositor(with_motion_blur(stage, settings), with_gather_of(level), true);
    const CompositedFrame frame = compositor->composite(*stage.plate);
    return cropped(frame.layers->beauty, region.moved(-frame.layers->region.x, -frame.layers->region.y));
}

/// One picture, at each level's taps, and several.
std::vector<MotionChoice> choices_of(const MotionBlurSettings& asked, bool quick) {
    MotionBlurSettings gathered = asked;
    gathered.level = MotionBlurLevel::gather;
    std::vector<MotionChoice> choices;
    for (const auto& [name, level] : quality_levels) {
        choices.push_back({fmt::format("gather, {}", name), {}, gathered, level});
    }
    for (const int sub_frames : quick ? std::vector<int>{8} : std::vector<int>{2, 4, 8, 16, 32}) {
        choices.push_back(
            {"sub_frames", {{"sub_frames", static_cast<double>(sub_frames)}}, drawn_at(asked, sub_frames)});
    }
    return choices;
}

}  // namespace

std::optional<Experiment> motion_blur_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    if (!stage.scene.effects.motion_blur && !options.by_name) return std::nullopt;
    const MotionBlurSettings asked = stage.scene.effects.motion_blur.value_or(MotionBlurSettings{});
    Experiment experiment;
    experiment.report.name = "motion_blur";
    experiment.report.what =
        "What moves while the shutter is open: one picture gathered along the way of each pixel, or the scene drawn at "
        "several times; the whole frame is timed.";
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const auto first = stage.compositor(with_motion_blur(stage, asked), quality_of(QualityLevel::final_), true);
    const CompositedFrame frame = first->composite(*stage.plate);
    if (!frame.layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    for (const PassReport& pass : first->reports()) {
        if (pass.name != "motion_blur") continue;
        experiment.report.left_out_of_frame = pass.why;
        return experiment;
    }
    const Region region = frame.layers->region;
    experiment.report.region = region;
    const int reference_times = options.quick ? 32 : 128;
    experiment.report.reference = fmt::format("the scene drawn at {} times", reference_times);
    experiment.reference = picture_of(stage, drawn_at(asked, reference_times), QualityLevel::final_, region);
    experiment.coarse_reference = picture_of(stage, drawn_at(asked, reference_times / 2), QualityLevel::final_, region);

    for (const MotionChoice& choice : choices_of(asked, options.quick)) {
        Candidate candidate;
        candidate.point = {.level = choice.level, .knobs = choice.knobs, .precision = "32F"};
        candidate.picture = [&stage, choice, region] {
            return picture_of(stage, choice.settings, choice.quality, region);
        };
        const std::shared_ptr<Compositor> compositor =
            stage.compositor(with_motion_blur(stage, choice.settings), with_gather_of(choice.quality), false);
        candidate.work = [&stage, compositor] { compositor->composite(*stage.plate); };
        if (choice.level == "gather, final") {
            MotionBlurSettings closed = choice.settings;
            closed.shutter = 0;
            const Quality quality = with_gather_of(choice.quality);
            const std::shared_ptr<Compositor> still = stage.compositor(with_motion_blur(stage, closed), quality, false);
            const auto drawn_all_the_same = std::make_shared<Compositor>(
                stage.context, with_motion_blur(stage, closed), stage.solve,
                CompositorOptions{.settings = quality, .leave_out = false}, stage.warnings);
            experiment.left_out =
                LeftOutTrial{.condition = "nothing moves by a quarter of a pixel",
                             .drawn = candidate.work,
                             .skipped = [&stage, still] { still->composite(*stage.plate); },
                             .code_difference =
                                 [&stage, still, drawn_all_the_same] {
                                     return largest_code_difference(drawn_all_the_same->composite(*stage.plate).rgb8(),
                                                                    still->composite(*stage.plate).rgb8());
                                 }};
        }
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

}  // namespace matchlight
