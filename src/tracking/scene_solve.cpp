// Poses and lens of a virtual camera in the solve's own terms.
#include "tracking/scene_solve.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "calibration/thin_lens.h"
#include "core/error.h"
#include "core/version.h"
#include "tracking/solve_freshness.h"

namespace matchlight {
namespace {

/// The picture's edges, half a pixel outside the outermost centres, span the angle of view.
Camera pinhole(const CameraSettings& settings) {
    Camera camera;
    camera.width = settings.width;
    camera.height = settings.height;
    camera.fx = camera.fy = settings.height / 2.0 / std::tan(settings.vertical_fov_deg / 2 * std::numbers::pi / 180);
    camera.cx = (settings.width - 1) / 2.0;
    camera.cy = (settings.height - 1) / 2.0;
    return camera;
}

RigidTransform camera_from_world(const CameraView& view, const Scene& scene, std::int64_t frame) {
    const Eigen::Vector3d forward = (view.target_m - view.eye_m).normalized();
    if (!(forward.norm() > 0.5)) {
        throw InputError(scene.path, frame, "[camera]: eye and target are one point",
                         "let the keys pass by each other");
    }
    return camera_looking_along(view.eye_m, forward);
}

/// The focal length is that which gives the angle of view while focused at that distance
/// (1/f = 1/image distance + 1/distance).
Focus focus_of(const LensSettings& settings, const Camera& camera) {
    const double image_distance_m = camera.fx * settings.sensor_width_mm / 1000 / camera.width;
    ThinLens lens;
    lens.focal_length_m = 1 / (1 / image_distance_m + 1 / settings.focus_distance_m);
    lens.f_number = settings.f_number;
    lens.focus_distance_m = settings.focus_distance_m;
    lens.sensor_width_m = settings.sensor_width_mm / 1000;
    lens.image_width_px = camera.width;
    return focus_of(lens);
}

}  // namespace

Solve virtual_solve(const Scene& scene) {
    const CameraSettings& settings = *scene.camera;
    Solve solve;
    solve.footage_file = scene.path.string();
    solve.frame_count = settings.frames;
    solve.camera = pinhole(settings);
    for (const RigTag& tag : scene.tags.rig) {
        if (tag.world_from_tag) solve.rig.push_back({tag.id, tag.size_m, *tag.world_from_tag});
    }
    for (std::int64_t i = 0; i < settings.frames; ++i) {
        SolvedFrame frame;
        frame.frame = i;
        frame.time_s = static_cast<double>(i) / settings.fps;
        frame.camera_from_world = camera_from_world(camera_view(settings, static_cast<double>(i)), scene, i);
        frame.exposure_ev = settings.exposure_ev;
        if (settings.lens) {
            const Focus focus = focus_of(*settings.lens, solve.camera);
            frame.focus_distance_m = focus.focus_distance_m;
            frame.coc_scale_px_m = focus.coc_scale_px_m;
        }
        solve.frames.push_back(frame);
    }
    solve.provenance = fmt::format("matchlight {}\n{}", version, scene.effective_toml);
    return solve;
}

Solve solve_of_scene(const Scene& scene, Warnings& warnings) {
    if (scene.camera) return virtual_solve(scene);
    const std::filesystem::path& path = scene.footage.solve;
    if (!std::filesystem::exists(path)) {
        throw InputError(path, "no such solve file", fmt::format("run: matchlight track {}", scene.path.string()));
    }
    Solve solve = load_solve(path);
    check_solve_is_of_scene(solve, scene, warnings);
    return solve;
}

}  // namespace matchlight
