// Grain against its reference: the noise of every pixel that something virtual is seen in.
#include <algorithm>
#include <memory>

#include "compositor/sensor.h"
#include "report/experiments.h"
#include "report/frame_trial.h"
#include "report/grain_reference.h"

namespace matchlight {
namespace {

Scene with_grain(const Scene& scene, const std::optional<GrainSettings>& grain) {
    Scene changed = scene;
    changed.effects.grain = grain;
    return changed;
}

ImageF grainy_reference(const FrameLayers& plain, const ImageF& plate, const GrainModel& model) {
    const ImageD noise = reference_grain_noise(model, plain.region);
    ImageF picture = plain.beauty;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const double light = plain.beauty.at(x, y, c);
                // Over a background of the scene's own there is no noise that was there before.
                const double kept =
                    plain.background.empty() ? plain.shadow.at(x, y, c) * (1 - plain.alpha.at(x, y)) : 0;
                const double own = plate.at(plain.region.x + x, plain.region.y + y, c);
                const double added = reference_grain_deviation(model, {light, own, kept}) * noise.at(x, y, c);
                if (added != 0) picture.at(x, y, c) = static_cast<float>(std::max(light + added, 0.0));
            }
        }
    }
    return picture;
}

}  // namespace

std::optional<Experiment> grain_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<GrainSettings> settings = stage.scene.effects.grain;
    if (!settings && !options.by_name) return std::nullopt;
    if (!settings) settings.emplace();
    Experiment experiment;
    experiment.report.name = "grain";
    experiment.report.what = "Noise on what is virtual, by how it is correlated: the whole frame is timed.";
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const std::optional<GrainModel> model =
        grain_of_frame(*settings, stage.solve, stage.plate->index(), 1, stage.warnings);
    const Quality quality = quality_of(QualityLevel::final_);
    const auto plain_compositor = stage.compositor(with_grain(stage.scene, std::nullopt), quality, true);
    const CompositedFrame plain = plain_compositor->composite(*stage.plate);
    if (!plain.layers || !model) {
        experiment.report.left_out_of_frame = model ? "nothing virtual is in view" : "the footage's noise is not known";
        return experiment;
    }
    const Region region = plain.layers->region;
    experiment.report.region = region;
    experiment.report.reference = "the same random numbers, quantiles and smoothing in double precision";
    experiment.reference = grainy_reference(*plain.layers, plain_compositor->plate_linear(*stage.plate), *model);

    const auto add = [&](const std::string& label, const std::optional<GrainSettings>& grain) {
        const Scene scene = with_grain(stage.scene, grain);
        Candidate candidate;
        candidate.point = {.level = label, .knobs = {}, .precision = "32F"};
        if (grain) candidate.point.knobs = {{"correlation_px", grain->correlation_px.value_or(model->correlation_px)}};
        candidate.picture = [&stage, scene, quality, region] {
            const auto compositor = stage.compositor(scene, quality, true);
            return beauty_over(*compositor, compositor->composite(*stage.plate), region);
        };
        const std::shared_ptr<Compositor> compositor = stage.compositor(scene, quality, false);
        candidate.work = [&stage, compositor] { compositor->composite(*stage.plate); };
        experiment.candidates.push_back(std::move(candidate));
    };
    add("final", settings);
    GrainSettings white = *settings;
    white.correlation_px = 0;
    if (model->correlation_px > 0) add("white", white);
    add("without grain", std::nullopt);

    GrainSettings faint = *settings;
    faint.strength = 0;
    const auto make = [&](const std::optional<GrainSettings>& grain) -> std::shared_ptr<Compositor> {
        // Both draw all that could be left out, so that grain alone is between them.
        return std::make_shared<Compositor>(stage.context, with_grain(stage.scene, grain), stage.solve,
                                            CompositorOptions{.settings = quality, .leave_out = false}, stage.warnings);
    };
    experiment.left_out =
        whole_frame_trial(stage, "none of its noise can move a code by half a step", make(faint), make(std::nullopt));
    return experiment;
}

}  // namespace matchlight
