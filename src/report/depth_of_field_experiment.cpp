// Depth of field by method, against the scene drawn from ever more points of the lens.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "compositor/focus.h"
#include "compositor/reach.h"
#include "core/transfer.h"
#include "render/virtual_layer.h"
#include "report/experiments.h"
#include "report/flip.h"
#include "report/image_error.h"
#include "report/thin_lens_reference.h"
#include "scene/depth_of_field_levels.h"

namespace matchlight {
namespace {

DepthOfFieldSettings with_lens_samples(DepthOfFieldSettings settings, int count) {
    settings.level = DepthOfFieldLevel::lens_samples;
    settings.lens_samples = count;
    return settings;
}

/// Light over the whole frame, and the mean of what the objects send.
struct DefocusedPicture {
    ImageF light;
    double object_light = 0;
};

/// The stage's frame with one depth of field or another, and otherwise the same: nothing that bright light spills.
class DefocusedFrames {
public:
    using Settings = std::optional<DepthOfFieldSettings>;

    explicit DefocusedFrames(const SceneStage& stage) : stage_(stage), scene_(stage.scene) {
        scene_.effects.bloom.reset();
        scene_.effects.glare.reset();
        scene_.effects.dazzle.reset();
    }

    CompositedFrame frame(const Settings& settings, QualityLevel level, bool layers) {
        EffectSettings effects = scene_.effects;
        effects.depth_of_field = settings;
        Compositor& with_level = compositor(level, layers);
        with_level.set_effects(effects);
        return with_level.composite(*stage_.plate);
    }

    DefocusedPicture picture(const Settings& settings, QualityLevel level) {
        const CompositedFrame made = frame(settings, level, true);
        DefocusedPicture picture{compositor(level, true).plate_linear(*stage_.plate), 0};
        if (!made.layers) return picture;
        const Region& region = made.layers->region;
        double sum = 0;
        for (int y = 0; y < region.height; ++y) {
            for (int x = 0; x < region.width; ++x) {
                std::copy_n(made.layers->beauty.pixel(x, y), 3, picture.light.pixel(region.x + x, region.y + y));
                const float* light = made.layers->virtual_rgba.pixel(x, y);
                sum += luminance_rec709(light[0], light[1], light[2]);
            }
        }
        picture.object_light = sum / (static_cast<double>(picture.light.width()) * picture.light.height());
        return picture;
    }

    /// Everything of the frame's scene but its depth of field.
    const Scene& scene() const { return scene_; }
    Compositor& compositor(QualityLevel level, bool layers) {
        std::shared_ptr<Compositor>& made = compositors_[{level, layers}];
        if (!made) {
            Quality quality = quality_of(QualityLevel::final_);
            quality.depth_of_field = level;
            made = stage_.compositor(scene_, quality, layers);
        }
        return *made;
    }

private:
    const SceneStage& stage_;
    Scene scene_;
    std::map<std::pair<QualityLevel, bool>, std::shared_ptr<Compositor>> compositors_;
};

/// Around all that depth of field changes.
Region changed_region(const ImageF& sharp, const ImageF& blurred) {
    Region region;
    for (int y = 0; y < sharp.height(); ++y) {
        const auto before = sharp.row(y), after = blurred.row(y);
        const auto first = std::ranges::mismatch(before, after).in1 - before.begin();
        if (first == static_cast<std::ptrdiff_t>(before.size())) continue;
        const auto last = std::mismatch(before.rbegin(), before.rend(), after.rbegin()).first - before.rbegin();
        const int left = static_cast<int>(first) / 3, right = sharp.width() - static_cast<int>(last) / 3;
        region = region.united({left, y, right - left, 1});
    }
    return region;
}

struct LensReference {
    DefocusedPicture fine, half;
    Region region;  // around all that depth of field changes
    int samples = 0;
    double sharp_light = 0;  // mean of what the objects send without depth of field
};

/// Twice as many points of the lens until that changes little, over the part of the frame that is blurred at all.
LensReference lens_reference(const SceneStage& stage, DefocusedFrames& frames, const DepthOfFieldSettings& settings,
                             bool quick) {
    // A quarter of the error, FLIP 0.02, that is asked of the best quick method.
    constexpr double wanted_flip = 0.02 / 4;
    const int most_samples = quick ? 128 : 4096;
    const DefocusedPicture sharp = frames.picture(std::nullopt, QualityLevel::final_);
    LensReference reference;
    reference.sharp_light = sharp.object_light;
    reference.samples = 32;
    reference.fine = frames.picture(with_lens_samples(settings, reference.samples), QualityLevel::final_);
    while (true) {
        reference.half = std::move(reference.fine);
        reference.samples *= 2;
        reference.fine = frames.picture(with_lens_samples(settings, reference.samples), QualityLevel::final_);
        reference.region = changed_region(sharp.light, reference.fine.light);
        if (reference.region.empty() || reference.samples >= most_samples) return reference;
        const Image8 fine = stage.code_of(cropped(reference.fine.light, reference.region));
        const Image8 half = stage.code_of(cropped(reference.half.light, reference.region));
        if (masked_mean(flip_error_map(fine, half)) < wanted_flip) return reference;
    }
}

/// Such that the widest circle of confusion of all that is in view is `widest_px`.
DepthOfFieldSettings with_widest_circle(const SceneStage& stage, Compositor& compositor, DepthOfFieldSettings settings,
                                        double widest_px) {
    const RigidTransform& camera_from_world = *stage.solved().camera_from_world;
    const LensMap lens_map = make_lens_map(stage.solve.camera);
    const SurfaceRenderer& surfaces = compositor.surfaces();
    settings.focus_on = FocusTarget::distance;
    settings.focus_distance_m = std::max(2 * near_plane_m, (camera_from_world * surfaces.bounds_m().center()).z());
    CocRange range;
    for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
        const Eigen::AlignedBox3d box_m = surfaces.object_bounds_m(i);
        if (normalized_bounds_of_box(box_m, camera_from_world, lens_map).isEmpty()) continue;
        range.extend(coc_range_of_box({.coc_scale_px_m = 1, .focus_distance_m = *settings.focus_distance_m}, box_m,
                                      {camera_from_world, lens_map.normalized_bounds, stage.solve.camera.fx}));
    }
    if (range.widest_px() > 0) settings.coc_scale_px_m = widest_px / range.widest_px();
    return settings;
}

LeftOutTrial left_out_trial(const SceneStage& stage, const std::shared_ptr<DefocusedFrames>& frames,
                            const DepthOfFieldSettings& settings) {
    // A little to either side of the width that counts.
    constexpr double wide_px = 1.05 * least_coc_px, narrow_px = 0.95 * least_coc_px;
    Compositor& compositor = frames->compositor(QualityLevel::final_, false);
    const DepthOfFieldSettings wide = with_widest_circle(stage, compositor, settings, wide_px);
    const DepthOfFieldSettings narrow = with_widest_circle(stage, compositor, settings, narrow_px);
    constexpr double highlight = 1e5;
    const SpreadPixel spread = spread_pixel(least_coc_px);
    return {.condition = fmt::format("no circle of confusion is {:g} pixels wide", least_coc_px),
            .drawn = [frames, wide] { frames->frame(wide, QualityLevel::final_, false); },
            .skipped = [frames, narrow] { frames->frame(narrow, QualityLevel::final_, false); },
            .code_difference =
                [&stage, frames, narrow] {
                    Scene scene = frames->scene();
                    scene.effects.depth_of_field = narrow;
                    const auto picture = [&](bool leave_out) {
                        Compositor made(
                            stage.context, scene, stage.solve,
                            {.settings = without_rays(quality_of(QualityLevel::final_)), .leave_out = leave_out},
                            stage.warnings);
                        return made.composite(*stage.plate).rgb8();
                    };
                    return largest_code_difference(picture(true), picture(false));
                },
            .cost = {{"share of a pixel's light that a circle just below it would move", spread.moved_share},
                     {fmt::format("light that a pixel beside a highlight of {:g} lacks", highlight),
                      highlight * spread.beside_share}}};
}

Candidate candidate_of(const std::shared_ptr<DefocusedFrames>& frames, const Region& region,
                       const DefocusedFrames::Settings& settings, QualityLevel level) {
    Candidate candidate;
    candidate.point.precision = "32F";
    const auto light = std::make_shared<double>(0);
    candidate.picture = [frames, region, settings, level, light] {
        const DefocusedPicture picture = frames->picture(settings, level);
        *light = picture.object_light;
        return cropped(picture.light, region);
    };
    candidate.light = [light] { return *light; };
    candidate.work = [frames, settings, level] { frames->frame(settings, level, false); };
    return candidate;
}

}  // namespace

std::optional<Experiment> depth_of_field_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    DefocusedFrames::Settings settings = stage.scene.effects.depth_of_field;
    if (!settings && options.by_name) settings.emplace();
    if (!settings) return std::nullopt;
    Experiment experiment;
    experiment.report.name = "depth_of_field";
    experiment.report.what =
        "What is out of focus, without bloom and glare: the whole frame is timed; \"off\" is the frame without. Every "
        "method sees the objects shaded as from the middle of the lens, lens_samples as from each of its points: "
        "highlights "
        "narrower than a sample differ in mean light, too. light_kept is the share of the unblurred picture's.";
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const auto frames = std::make_shared<DefocusedFrames>(stage);
    LensReference reference = lens_reference(stage, *frames, *settings, options.quick);
    if (reference.region.empty()) {
        experiment.report.left_out_of_frame =
            fmt::format("no circle of confusion is {:g} pixels wide, or nothing virtual is in view", least_coc_px);
        return experiment;
    }
    const Region region = experiment.report.region = reference.region;
    experiment.report.reference = fmt::format("the scene drawn from {} points of the lens", reference.samples);
    experiment.reference = cropped(reference.fine.light, region);
    experiment.coarse_reference = cropped(reference.half.light, region);
    experiment.reference_light = reference.fine.object_light;
    experiment.input_light = reference.sharp_light;

    const auto add = [&](const std::string& label, const DefocusedFrames::Settings& tried,
                         QualityLevel level = QualityLevel::final_) -> Candidate& {
        Candidate& added = experiment.candidates.emplace_back(candidate_of(frames, region, tried, level));
        added.point.level = label;
        return added;
    };
    add("off", std::nullopt);
    for (std::size_t i = 0; i < depth_of_field_levels.size(); ++i) {
        DepthOfFieldSettings tried = *settings;
        tried.level = static_cast<DepthOfFieldLevel>(i);
        const std::string name(depth_of_field_levels[i]);
        if (tried.level == DepthOfFieldLevel::lens_samples) continue;
        if (tried.level != DepthOfFieldLevel::gather) {
            add(name, tried);
            continue;
        }
        for (const auto& [quality, level] : quality_levels) add(fmt::format("{} {}", name, quality), tried, level);
    }
    for (int count = 1; count <= std::min(64, reference.samples / 2); count *= options.quick ? 4 : 2) {
        add(fmt::format("lens_samples {}", count), with_lens_samples(*settings, count)).point.knobs = {
            {"lens_samples", static_cast<double>(count)}};
    }
    experiment.left_out = left_out_trial(stage, frames, *settings);
    return experiment;
}

}  // namespace matchlight
