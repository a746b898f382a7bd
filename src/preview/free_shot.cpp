// One compositor for the flight: from picture to picture only a pose changes.
#include "preview/free_shot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "preview/free_view.h"
#include "scene/footage_options.h"
#include "tracking/scene_solve.h"

namespace matchlight {

namespace {

/// Of the footage's own, so that the light is as bright as in it.
double exposure_of(const Solve& solve) {
    const auto known =
        std::ranges::find_if(solve.frames, [](const SolvedFrame& frame) { return frame.exposure_ev.has_value(); });
    return known == solve.frames.end() ? 0 : *known->exposure_ev;
}

double frame_rate_of(const Solve& solve) {
    constexpr double usual = 25;
    if (solve.frames.size() < 2) return usual;
    const SolvedFrame &first = solve.frames.front(), &last = solve.frames.back();
    const double seconds = last.time_s - first.time_s;
    return seconds > 0 ? static_cast<double>(last.frame - first.frame) / seconds : usual;
}

}  // namespace

Scene without_footage(const Scene& scene, const Solve& solve, const CameraView& view) {
    Scene free = scene;
    free.budget_ms.reset();
    free.effects.exposure.reset();
    if (!scene.camera) {
        free.footage = {};
        free.surface.present = false;
        free.effects.depth_of_field.reset();
        free.effects.motion_blur.reset();
        free.effects.grain.reset();
        free.effects.vignette.reset();
        free.effects.chromatic_aberration.reset();
        free.effects.softness.reset();
        CameraSettings& camera = free.camera.emplace();
        camera.width = solve.camera.width;
        camera.height = solve.camera.height;
        camera.frames = solve.frame_count;
        camera.fps = frame_rate_of(solve);
        camera.vertical_fov_deg = 2 * std::atan2(solve.camera.height / 2.0, solve.camera.fy) * 180 / std::numbers::pi;
        camera.exposure_ev = exposure_of(solve);
        free.background.probe = scene.probe.has_value();
    }
    free.camera->orbit.reset();
    free.camera->keys = {{.frame = 0, .eye_m = view.eye_m, .target_m = view.target_m}};
    return free;
}

FreeShot::FreeShot(GlContext& context, const Scene& scene, const Solve& solve, const CameraView& view,
                   Warnings& warnings)
    : shot_solve_(solve),
      first_view_(view),
      scene_(without_footage(scene, solve, view)),
      solve_(virtual_solve(scene_)),
      frames_(open_frames(scene_, false, warnings)) {
    solve_.rig = solve.rig;  // objects may stand on tags whose place was solved
    const CompositorOptions options{.quality = scene_.quality};
    compositor_ = std::make_unique<Compositor>(context, scene_, solve_, options, warnings);
}

bool FreeShot::set_scene(const Scene& scene) {
    scene_ = without_footage(scene, shot_solve_, first_view_);
    return compositor_->set_scene(scene_);
}

Image8 FreeShot::picture(std::int64_t frame, const CameraView& view) {
    compositor_->set_pose(frame, pose_of_view(view));
    frames_->seek(frame);
    return compositor_->composite(*frames_->next()).rgb8();
}

}  // namespace matchlight
