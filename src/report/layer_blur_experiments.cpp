// What the lens does to colours, the codec to edges and grading to both, each against its reference.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "compositor/sensor.h"
#include "render/effects/color_transform.h"
#include "render/effects/softness.h"
#include "report/color_transform_reference.h"
#include "report/experiments.h"
#include "report/frame_trial.h"
#include "report/softness_reference.h"

namespace matchlight {
namespace {

using ChangeScene = std::function<void(Scene&)>;

/// How a whole frame is composited with a changed scene.
struct FrameWay {
    std::string label;
    std::vector<Knob> knobs;
    Quality quality;
    ChangeScene change;
};

Scene changed(const SceneStage& stage, const ChangeScene& change) {
    Scene scene = stage.scene;
    change(scene);
    return scene;
}

Candidate candidate_of(const SceneStage& stage, const FrameWay& way, const Region& region) {
    Candidate candidate;
    candidate.point = {.level = way.label, .knobs = way.knobs, .precision = "32F"};
    candidate.picture = [&stage, way, region] {
        const auto compositor = stage.compositor(changed(stage, way.change), way.quality, true);
        return beauty_over(*compositor, compositor->composite(*stage.plate), region);
    };
    const std::shared_ptr<Compositor> compositor = stage.compositor(changed(stage, way.change), way.quality, false);
    candidate.work = [&stage, compositor] { compositor->composite(*stage.plate); };
    return candidate;
}

/// What leaving the effect out saves, where `faint` makes it one that does nothing and `off` turns it off.
LeftOutTrial left_out_trial(const SceneStage& stage, const std::string& condition, const ChangeScene& faint,
                            const ChangeScene& off) {
    const auto make = [&](const ChangeScene& change) -> std::shared_ptr<Compositor> {
        // Both draw all that could be left out, so that the effect alone is between them.
        return std::make_shared<Compositor>(
            stage.context, changed(stage, change), stage.solve,
            CompositorOptions{.settings = quality_of(QualityLevel::final_), .leave_out = false}, stage.warnings);
    };
    return whole_frame_trial(stage, condition, make(faint), make(off));
}

/// The effect at the levels that differ, and the picture without it.
std::vector<FrameWay> ways_of(const std::vector<std::pair<std::string, QualityLevel>>& levels, const ChangeScene& on,
                              const ChangeScene& off) {
    std::vector<FrameWay> ways;
    for (const auto& [name, level] : levels) {
        Quality quality = quality_of(QualityLevel::final_);
        quality.sensor = level;
        ways.push_back({name, {}, quality, on});
    }
    ways.push_back({"without", {}, quality_of(QualityLevel::final_), off});
    return ways;
}

/// One channel as the scene's camera sees it whose lens magnifies by so many pixels more at the frame's corner.
ImageF magnified_picture(const SceneStage& stage, const Scene& scene, double corner_px, const Region& region) {
    Solve solve = stage.solve;
    Camera& camera = solve.camera;
    // What is shown at a radius r came from r (1 - k).
    const double scale = 1 / (1 - corner_px / (std::hypot(camera.width, camera.height) / 2));
    const double x = (camera.width - 1) / 2.0, y = (camera.height - 1) / 2.0;
    camera.fx *= scale;
    camera.fy *= scale;
    camera.cx = x + (camera.cx - x) * scale;
    camera.cy = y + (camera.cy - y) * scale;
    Compositor compositor(stage.context, scene, solve,
                          {.settings = without_rays(quality_of(QualityLevel::final_)), .layers = true}, stage.warnings);
    const CompositedFrame frame = compositor.composite(*stage.plate);
    return beauty_over(compositor, frame, region);
}

}  // namespace

std::optional<Experiment> chromatic_aberration_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<ChromaticAberrationSettings> settings = stage.scene.effects.chromatic_aberration;
    if (!settings && !options.by_name) return std::nullopt;
    // As a lens of a consumer's camera may do it.
    if (!settings) settings = ChromaticAberrationSettings{.red_px = 3, .blue_px = -3};
    Experiment experiment;
    experiment.report.name = "chromatic_aberration";
    experiment.report.what =
        "Red and blue of what is virtual displaced, without shadows: the whole frame is timed. Displacements under a "
        "quarter pixel count as none here, not in the reference.";
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const ChangeScene off = [](Scene& scene) {
        scene.effects = {};
        scene.surface.shadow = false;
    };
    const auto on_with = [off](const ChromaticAberrationSettings& values) -> ChangeScene {
        return [off, values](Scene& scene) {
            off(scene);
            scene.effects.chromatic_aberration = values;
        };
    };
    const CompositedFrame frame =
        stage.compositor(changed(stage, on_with(*settings)), quality_of(QualityLevel::final_), true)
            ->composite(*stage.plate);
    if (!frame.layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    const Region region = frame.layers->region;
    experiment.report.region = region;
    experiment.report.reference = "the scene drawn three times, by a lens for each colour";
    const Scene plain = changed(stage, off);
    const ImageF red = magnified_picture(stage, plain, settings->red_px.value_or(0), region);
    const ImageF green = magnified_picture(stage, plain, 0, region);
    const ImageF blue = magnified_picture(stage, plain, settings->blue_px.value_or(0), region);
    experiment.reference = green;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            experiment.reference.at(x, y, 0) = red.at(x, y, 0);
            experiment.reference.at(x, y, 2) = blue.at(x, y, 2);
        }
    }
    for (const FrameWay& way :
         ways_of({{"draft, preview", QualityLevel::draft}, {"final", QualityLevel::final_}}, on_with(*settings), off)) {
        experiment.candidates.push_back(candidate_of(stage, way, region));
    }
    experiment.left_out = left_out_trial(stage, "nothing in view is displaced by a quarter pixel",
                                         on_with({.red_px = 0.25, .blue_px = 0.25}), off);
    return experiment;
}

namespace {

/// An effect on the layer as it lies on the plate, against what `reference` makes of the layer without it.
struct LayerTrial {
    std::string name, what, reference_is;
    std::function<ImageD(const ImageD& layer)> reference;  // plate-linear, premultiplied, over the whole frame
    std::vector<std::pair<std::string, QualityLevel>> levels;
    std::function<void(EffectSettings&effects)> on, faint;
    std::string left_out_where;  // that `faint` is
};

/// The frame with that layer over its plate.
ImageF over_plate(const FrameLayers& layers, const ImageF& plate, const ImageD& layer) {
    const Region& region = layers.region;
    ImageF picture(region.width, region.height, 3);
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            const double* over = layer.pixel(region.x + x, region.y + y);
            for (int c = 0; c < 3; ++c) {
                picture.at(x, y, c) =
                    static_cast<float>(plate.at(x, y, c) * layers.shadow.at(x, y, c) * (1 - over[3]) + over[c]);
            }
        }
    }
    return picture;
}

Experiment layer_experiment(const SceneStage& stage, const LayerTrial& trial) {
    Experiment experiment;
    experiment.report.name = trial.name;
    experiment.report.what = trial.what;
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const ChangeScene off = [](Scene& scene) { scene.effects = {}; };
    const auto only = [](const std::function<void(EffectSettings&)>& change) -> ChangeScene {
        return [change](Scene& scene) {
            scene.effects = {};
            change(scene.effects);
        };
    };
    const auto plain_compositor = stage.compositor(changed(stage, off), quality_of(QualityLevel::final_), true);
    const CompositedFrame plain = plain_compositor->composite(*stage.plate);
    if (!plain.layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    const FrameLayers& layers = *plain.layers;
    const Region region = layers.region;
    experiment.report.region = region;
    experiment.report.reference = trial.reference_is;
    // Over the whole frame, so that only its own edges are edges.
    ImageD layer(stage.plate->format().width, stage.plate->format().height, 4);
    for (int y = 0; y < region.height; ++y)
        std::ranges::copy(layers.virtual_rgba.row(y), layer.pixel(region.x, region.y + y));
    const ImageF plate =
        layers.background.empty() ? cropped(plain_compositor->plate_linear(*stage.plate), region) : layers.background;
    experiment.reference = over_plate(layers, plate, trial.reference(layer));
    for (const FrameWay& way : ways_of(trial.levels, only(trial.on), off))
        experiment.candidates.push_back(candidate_of(stage, way, region));
    experiment.left_out = left_out_trial(stage, trial.left_out_where, only(trial.faint), off);
    return experiment;
}

}  // namespace

std::optional<Experiment> softness_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<SoftnessSettings> settings = stage.scene.effects.softness;
    if (!settings && !options.by_name) return std::nullopt;
    if (!settings) settings.emplace();
    const double sigma_px = softness_px_of(*settings, stage.solve, stage.warnings);
    if (sigma_px < least_softness_px) {
        Experiment none;
        none.report.name = "softness";
        none.report.left_out_of_frame = "a Gaussian this narrow is none";
        return none;
    }
    return layer_experiment(
        stage, {.name = "softness",
                .what = "The Gaussian of codec and resampling over what is virtual: the whole frame is timed.",
                .reference_is = "Gaussians to 8 standard deviations in double precision",
                .reference = [sigma_px](const ImageD& layer) { return reference_softness(layer, sigma_px); },
                .levels = {{"draft", QualityLevel::draft},
                           {"preview", QualityLevel::preview},
                           {"final", QualityLevel::final_},
                           {"reference", QualityLevel::reference}},
                .on = [sigma_px](EffectSettings& effects) { effects.softness = SoftnessSettings{sigma_px}; },
                .faint = [](EffectSettings& effects) { effects.softness = SoftnessSettings{least_softness_px / 2}; },
                .left_out_where = "its standard deviation is under 0.2 px"});
}

std::optional<Experiment> color_transform_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<ColorTransformSettings> settings = stage.scene.effects.color_transform;
    if (!settings && !options.by_name) return std::nullopt;
    if (!settings) settings = ColorTransformSettings{.hue_deg = 40, .saturation = 0.7, .contrast = 1.3, .fade = 0.1};
    settings->mask.clear();
    const auto table = std::make_shared<const std::optional<ColorTable>>(ColorTransformFiles::read(*settings).table);
    return layer_experiment(
        stage, {.name = "color_transform",
                .what = "What is virtual in other colours, without the scene's mask: the whole frame is timed.",
                .reference_is = "the same steps in double precision",
                .reference =
                    [settings, table](ImageD layer) {
                        reference_transform_layer(layer, {1, 1, 1}, *settings, *table ? &**table : nullptr);
                        return layer;
                    },
                .levels = {{"draft", QualityLevel::draft},
                           {"preview", QualityLevel::preview},
                           {"final, reference", QualityLevel::final_}},
                .on = [settings](EffectSettings& effects) { effects.color_transform = settings; },
                .faint = [](EffectSettings& effects) { effects.color_transform.emplace(); },
                .left_out_where = "it changes no colour"});
}

std::optional<Experiment> repeated_blur_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<RepeatedBlurSettings> settings = stage.scene.effects.repeated_blur;
    if (!settings && !options.by_name) return std::nullopt;
    if (!settings) settings.emplace();
    return layer_experiment(
        stage,
        {.name = "repeated_blur",
         .what = "Repeated boxes over what is virtual: the whole frame is timed.",
         .reference_is = "the boxes in double precision",
         .reference = [settings](const ImageD& layer) { return reference_repeated_blur(layer, *settings); },
         .levels = {{"draft", QualityLevel::draft},
                    {"preview", QualityLevel::preview},
                    {"final, reference", QualityLevel::final_}},
         .on = [settings](EffectSettings& effects) { effects.repeated_blur = settings; },
         .faint =
             [](EffectSettings& effects) { effects.repeated_blur = RepeatedBlurSettings{.passes = 1, .radius_px = 0}; },
         .left_out_where = "its box is one pixel wide"});
}

}  // namespace matchlight
