// The frame's light on its own stage, and the picture with what each way adds.
#include "report/spill_experiment.h"

#include <algorithm>
#include <memory>

namespace matchlight {
namespace {

/// picture + added, never below 0.
ImageF with_added(const ImageF& picture, const ImageF& added) {
    if (added.empty()) return picture;
    ImageF sum = picture;
    std::ranges::transform(picture.samples(), added.samples(), sum.samples().begin(),
                           [](float a, float b) { return std::max(a + b, 0.0F); });
    return sum;
}

ImageF narrowed(const ImageD& light) {
    ImageF narrow(light.width(), light.height(), light.channels());
    std::ranges::transform(light.samples(), narrow.samples().begin(),
                           [](double value) { return static_cast<float>(value); });
    return narrow;
}

FrameLightImages held_below(FrameLightImages light, double limit) {
    for (ImageF* image : {&light.after, &light.before}) {
        for (int y = 0; y < image->height(); ++y) {
            for (int x = 0; x < image->width(); ++x) {
                for (int c = 0; c < 3; ++c) {
                    image->at(x, y, c) = std::min(image->at(x, y, c), static_cast<float>(limit));
                }
            }
        }
    }
    return light;
}

}  // namespace

FrameLightImages frame_light_of(const SceneStage& stage) {
    Scene plain = stage.scene;
    plain.effects = {};
    const auto compositor = stage.compositor(plain, quality_of(QualityLevel::final_), true);
    const CompositedFrame frame = compositor->composite(*stage.plate);
    FrameLightImages light;
    light.frame_width = stage.plate->format().width;
    light.frame_height = stage.plate->format().height;
    if (!frame.layers) return light;
    const FrameLayers& layers = *frame.layers;
    light.region = layers.region;
    light.after = ImageF(layers.region.width, layers.region.height, 4);
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            std::copy_n(layers.beauty.pixel(x, y), 3, light.after.pixel(x, y));
            light.after.at(x, y, 3) = layers.alpha.at(x, y);
        }
    }
    // Over a background of the scene's own no light has spilled yet.
    if (layers.background.empty()) light.before = cropped(compositor->plate_linear(*stage.plate), layers.region);
    return light;
}

ImageF frame_picture(const SceneStage& stage, const FrameLightImages& light) {
    const auto compositor = stage.compositor(stage.scene, quality_of(QualityLevel::draft), false);
    ImageF picture = compositor->plate_linear(*stage.plate);
    const Region& region = light.region;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            std::copy_n(light.after.pixel(x, y), 3, picture.pixel(region.x + x, region.y + y));
        }
    }
    return picture;
}

FrameLightImages over_whole_frame(const FrameLightImages& light) {
    FrameLightImages whole = light;
    whole.region = {0, 0, light.frame_width, light.frame_height};
    const auto placed = [&](const ImageF& part) {
        if (part.empty()) return ImageF();
        ImageF image(whole.region.width, whole.region.height, part.channels());
        for (int y = 0; y < part.height(); ++y) {
            std::ranges::copy(part.row(y), image.pixel(light.region.x, light.region.y + y));
        }
        return image;
    };
    whole.after = placed(light.after);
    whole.before = placed(light.before);
    return whole;
}

Experiment make_experiment(const SceneStage& stage, const SpillExperiment& spill) {
    Experiment experiment;
    experiment.report.name = spill.name;
    experiment.report.what = spill.what;
    experiment.report.unit = WorkUnit::frame;
    const FrameLightImages light = frame_light_of(stage);
    if (light.after.empty()) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    experiment.report.region = {0, 0, light.frame_width, light.frame_height};
    const auto lit = std::make_shared<EffectStage>(light);
    const SpillWay& final_way = spill.ways.at(spill.final_way);
    lit->draw(final_way.add);
    if (!lit->found()) {
        experiment.report.left_out_of_frame = "no light above the threshold";
    } else {
        experiment.report.reference = spill.reference_words;
        const FrameLightImages whole = over_whole_frame(light);
        const auto picture = std::make_shared<ImageF>(frame_picture(stage, light));
        experiment.reference = with_added(*picture, narrowed(spill.reference(whole, false)));
        const ImageD with_half = spill.reference(whole, true);
        if (!with_half.empty()) experiment.coarse_reference = with_added(*picture, narrowed(with_half));
        for (const SpillWay& way : spill.ways) {
            Candidate candidate;
            candidate.point = {.level = way.label, .knobs = way.knobs, .precision = way.precision};
            candidate.work = [lit, add = way.add] { lit->draw(add); };
            candidate.picture = [lit, picture, add = way.add] {
                lit->draw(add);
                return with_added(*picture, lit->added());
            };
            candidate.bytes = [lit] { return lit->bytes(); };
            experiment.candidates.push_back(std::move(candidate));
        }
    }
    const auto dark = std::make_shared<EffectStage>(held_below(light, spill.dark_below));
    const auto forced = [dark, add = final_way.add] { dark->draw(add, {.leaves_out = false}); };
    experiment.left_out =
        LeftOutTrial{.condition = "no light above the threshold",
                     .drawn = forced,
                     .skipped = [dark, add = final_way.add] { dark->draw(add); },
                     .code_difference =
                         [&stage, dark, forced, held = held_below(light, spill.dark_below)] {
                             const ImageF picture = frame_picture(stage, held);
                             forced();
                             return largest_code_difference(stage.code_of(with_added(picture, dark->added())),
                                                            stage.code_of(picture));
                         }};
    return experiment;
}

}  // namespace matchlight
