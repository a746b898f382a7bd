// The shadow on the real surface out of focus, by level, against rays through every part of the lens.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "compositor/focus.h"
#include "compositor/scene_focus.h"
#include "core/parallel.h"
#include "render/virtual_layer.h"
#include "report/experiments.h"
#include "report/frame_trial.h"
#include "report/surface_defocus_reference.h"

namespace matchlight {
namespace {

/// The stage's scene with its shadows alone out of focus, or nothing.
Scene shadow_scene(const SceneStage& stage, const std::optional<DepthOfFieldSettings>& settings) {
    Scene scene = stage.scene;
    scene.effects = {};
    scene.effects.depth_of_field = settings;
    for (ObjectSettings& object : scene.objects) object.focus = FocusOverride{};
    return scene;
}

Quality quality_with(QualityLevel level) {
    Quality quality = quality_of(QualityLevel::final_);
    quality.depth_of_field = level;
    return quality;
}

/// The real surface's light without its shadow, over the region.
ImageF unshadowed_light(const Compositor& compositor, const SceneStage& stage, const CompositedFrame& frame,
                        const Region& region) {
    const ImageF& background = frame.layers->background;
    return cropped(background.empty() ? compositor.plate_linear(*stage.plate) : background, region);
}

/// The surface's light under its shadow, over the frame's region, without the objects before it.
ImageF surface_light(const Compositor& compositor, const SceneStage& stage, const CompositedFrame& frame,
                     const Region& region) {
    ImageF light = unshadowed_light(compositor, stage, frame, region);
    const Region& had = frame.layers->region;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            const int from_x = region.x + x - had.x, from_y = region.y + y - had.y;
            if (!had.moved(-had.x, -had.y).contains(from_x, from_y)) continue;
            for (int c = 0; c < 3; ++c) light.at(x, y, c) *= frame.layers->shadow.at(from_x, from_y, c);
        }
    }
    return light;
}

/// The sharp shadow as the picture has it, by the surface's points; beyond the frame its rim goes on.
SurfaceRatio ratio_of(const SceneStage& stage, const FrameLayers& sharp) {
    return [&stage, &sharp, camera_from_world = *stage.solved().camera_from_world](const Eigen::Vector2d& point_m) {
        const Eigen::Vector3d seen_m =
            camera_from_world * Eigen::Vector3d(point_m.x(), point_m.y(), stage.scene.surface.z_m);
        if (seen_m.z() <= 0) return Eigen::Vector3d(Eigen::Vector3d::Ones());
        const Camera& camera = stage.solve.camera;
        const Eigen::Vector2d pixel = camera.pixel_from_camera(seen_m);
        const double u = std::clamp(pixel.x(), 0.0, camera.width - 1.001),
                     v = std::clamp(pixel.y(), 0.0, camera.height - 1.001);
        const int left = static_cast<int>(u), top = static_cast<int>(v);
        const auto texel = [&](int x, int y) -> Eigen::Vector3d {
            x -= sharp.region.x;
            y -= sharp.region.y;
            if (!sharp.shadow.bounds().contains(x, y)) return Eigen::Vector3d::Ones();
            return Eigen::Map<const Eigen::Vector3f>(sharp.shadow.pixel(x, y)).cast<double>();
        };
        const double s = u - left, t = v - top;
        return Eigen::Vector3d((1 - t) * ((1 - s) * texel(left, top) + s * texel(left + 1, top)) +
                               t * ((1 - s) * texel(left, top + 1) + s * texel(left + 1, top + 1)));
    };
}

/// What `light` without any shadow becomes under the blurred one.
ImageF reference_light(const SceneStage& stage, const ImageF& light, const Region& region, const SurfaceLensView& view,
                       const SurfaceRatio& ratio) {
    ImageF picture = light;
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const Eigen::Vector2d normalized = stage.solve.camera.normalized_from_pixel({region.x + x, region.y + y});
            if (!normalized.allFinite()) continue;
            const Eigen::Vector3d left = reference_surface_ratio(view, normalized, ratio);
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(light.at(x, y, c) * left[c]);
        }
    });
    return picture;
}

}  // namespace

std::optional<Experiment> surface_defocus_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    std::optional<DepthOfFieldSettings> settings = stage.scene.effects.depth_of_field;
    if (!settings && options.by_name) settings.emplace();
    if (!settings || !stage.scene.surface.present) return std::nullopt;
    settings->level = DepthOfFieldLevel::gather;
    Experiment experiment;
    experiment.report.name = "surface_defocus";
    experiment.report.what =
        "The shadow on the real surface, out of focus as the surface is; objects are sharp, and not in the picture. "
        "The whole frame is timed.";
    experiment.report.unit = WorkUnit::frame;
    experiment.stopwatch = Stopwatch::wall;
    const auto first = stage.compositor(shadow_scene(stage, settings), quality_with(QualityLevel::final_), true);
    const CompositedFrame blurred = first->composite(*stage.plate);
    for (const PassReport& pass : first->reports()) {
        if (pass.name == "surface defocus") experiment.report.left_out_of_frame = pass.why;
    }
    if (!blurred.layers) experiment.report.left_out_of_frame = "nothing virtual is in view";
    if (!experiment.report.left_out_of_frame.empty()) return experiment;
    const Region region = experiment.report.region = blurred.layers->region;

    const auto plain = stage.compositor(shadow_scene(stage, {}), quality_with(QualityLevel::final_), true);
    const CompositedFrame sharp = plain->composite(*stage.plate);
    const RigidTransform& camera_from_world = *stage.solved().camera_from_world;
    SceneFocus scene_focus(stage.scene, stage.solve.camera, first->surfaces());
    const Focus focus =
        focus_of_frame(*settings, stage.solve, stage.solved(),
                       scene_focus.depth_m(*settings, camera_from_world, stage.warnings), stage.warnings);
    // About so many rays as half a minute of one core has time for.
    const double rays_a_pixel = (options.quick ? 2e7 : 2e8) / (static_cast<double>(region.width) * region.height);
    SurfaceLensView view{.camera_from_world = camera_from_world,
                         .surface_z_m = stage.scene.surface.z_m,
                         .focus = focus,
                         .focal_px = std::sqrt(stage.solve.camera.fx * stage.solve.camera.fy),
                         .bokeh = settings->bokeh,
                         .lens_steps = static_cast<int>(std::clamp(std::sqrt(rays_a_pixel), 8.0, 64.0))};
    experiment.report.reference = fmt::format("{} × {} points of the square around the opening, in double precision",
                                              view.lens_steps, view.lens_steps);
    const ImageF light = unshadowed_light(*plain, stage, sharp, region);
    const SurfaceRatio ratio = ratio_of(stage, *sharp.layers);
    experiment.reference = reference_light(stage, light, region, view, ratio);
    view.lens_steps /= 2;
    experiment.coarse_reference = reference_light(stage, light, region, view, ratio);

    const auto add = [&](const std::string& label, const std::optional<DepthOfFieldSettings>& tried,
                         QualityLevel level) {
        Candidate& candidate = experiment.candidates.emplace_back();
        candidate.point.level = label;
        candidate.point.precision = "32F";
        candidate.picture = [&stage, tried, level, region] {
            const auto compositor = stage.compositor(shadow_scene(stage, tried), quality_with(level), true);
            return surface_light(*compositor, stage, compositor->composite(*stage.plate), region);
        };
        const std::shared_ptr<Compositor> compositor =
            stage.compositor(shadow_scene(stage, tried), quality_with(level), false);
        candidate.work = [&stage, compositor] { compositor->composite(*stage.plate); };
    };
    add("without", std::nullopt, QualityLevel::final_);
    for (const auto& [name, level] : quality_levels) add(std::string(name), settings, level);

    DepthOfFieldSettings faint = *settings;
    // Nothing that is seen is nearer than the near plane, where the circle would be a quarter pixel.
    faint.coc_scale_px_m = 0.5 * least_coc_px * near_plane_m;
    const auto made = [&](const std::optional<DepthOfFieldSettings>& tried) -> std::shared_ptr<Compositor> {
        return std::make_shared<Compositor>(
            stage.context, shadow_scene(stage, tried), stage.solve,
            CompositorOptions{.settings = quality_with(QualityLevel::final_), .leave_out = false}, stage.warnings);
    };
    experiment.left_out =
        whole_frame_trial(stage, "where the shadow is seen no circle is a quarter pixel wide", made(faint), made({}));
    return experiment;
}

}  // namespace matchlight
