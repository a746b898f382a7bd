// A small solve with poses that are hard for some formats, and the pixels its points must come out at.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "core/warnings.h"
#include "exchange/camera_track.h"

namespace matchlight::test {

/// A camera at `place_m` that looks along `forward`, with the picture's right along `right`.
inline RigidTransform looking(const Eigen::Vector3d& place_m, const Eigen::Vector3d& forward,
                              const Eigen::Vector3d& right) {
    RigidTransform world_from_camera = RigidTransform::Identity();
    world_from_camera.linear().col(2) = forward.normalized();
    world_from_camera.linear().col(0) = (right - right.dot(forward.normalized()) * forward.normalized()).normalized();
    world_from_camera.linear().col(1) = world_from_camera.linear().col(2).cross(world_from_camera.linear().col(0));
    world_from_camera.translation() = place_m;
    return world_from_camera.inverse();
}

inline Camera wide_camera() {
    Camera camera;
    camera.width = 1280;
    camera.height = 720;
    camera.fx = 900;
    camera.fy = 905;
    camera.cx = 645.5;
    camera.cy = 351.25;
    camera.distortion = {-0.12, 0.03, 0.0005, -0.0003, 0.002};
    return camera;
}

/// Ten frames at 24 a second over two tags: around, straight down onto them (where Euler angles lock), rolled over, and
/// two frames without a pose.
inline Solve made_solve() {
    Solve solve;
    solve.footage_file = "clip.mp4";
    solve.camera = wide_camera();
    RigidTransform second = RigidTransform::Identity();
    second.translate(Eigen::Vector3d(0.2, 0.05, 0.01));
    second.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()));
    solve.rig = {{0, 0.08, RigidTransform::Identity()}, {7, 0.05, second}};
    for (int i = 0; i < 10; ++i) {
        SolvedFrame& frame = solve.frames.emplace_back();
        frame.frame = i;
        frame.time_s = i / 24.0;
        if (i == 4 || i == 5) continue;
        const double angle = 0.3 * i;
        const Eigen::Vector3d place(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0.5);
        frame.camera_from_world = looking(place, Eigen::Vector3d(0.1, 0, 0) - place, Eigen::Vector3d(0, 1, 0.1 * i));
        if (i == 2) {  // straight down
            frame.camera_from_world = looking({0.1, 0, 0.6}, {0, 0, -1}, {std::cos(angle), std::sin(angle), 0});
        }
        if (i == 3) {  // all but straight down
            frame.camera_from_world = looking({0.1, 0, 0.6}, {1e-7, -2e-7, -1}, {std::cos(1.2), std::sin(1.2), 0});
        }
        frame.tags = {0, 7};
        frame.reprojection_px = 0.05;
        frame.exposure_ev = -1 + 0.1 * i;
        frame.white_balance = {1.05, 1, 0.95};
        frame.focus_distance_m = 0.6;
        frame.coc_scale_px_m = 11.25;  // fx · 12.5 mm of opening: f/2 for the 25 mm that fx stands for on 35.555… mm
        frame.shutter_fraction = 0.5;
    }
    solve.frame_count = 10;
    return solve;
}

inline CameraTrack track_of(const Solve& solve, const CameraTrackOptions& options = {}) {
    Warnings warnings;
    warnings.set_quiet(true);
    return camera_track(solve, options, "clip.solve.json", warnings);
}

/// The rig's corners in the world.
inline std::vector<Eigen::Vector3d> corners_of(const std::vector<SolvedTag>& rig) {
    std::vector<Eigen::Vector3d> corners;
    for (const SolvedTag& tag : rig) {
        const Eigen::Matrix<double, 3, 4> placed = tag.world_from_tag * tag_corners_m(tag.size_m);
        for (int i = 0; i < 4; ++i) corners.emplace_back(placed.col(i));
    }
    return corners;
}

/// Where a corner lies in the undistorted picture, from the solve itself.
inline Eigen::Vector2d expected_px(const CameraTrack& track, const SolvedFrame& frame, const Eigen::Vector3d& corner) {
    const Eigen::Vector3d seen = *frame.camera_from_world * corner;
    const PinholePicture& p = track.pinhole;
    return {p.fx * seen.x() / seen.z() + p.cx, p.fy * seen.y() / seen.z() + p.cy};
}

/// Files keep floats or text of doubles; a projection through either is to agree to a thousandth of a pixel.
inline constexpr double agreement_px = 1e-3;

}  // namespace matchlight::test
