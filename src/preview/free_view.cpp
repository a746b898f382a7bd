// Angles about the vertical and against the horizon; directions of the picture from the pose itself.
#include "preview/free_view.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

using Eigen::Vector3d;

CameraView view_of_pose(const RigidTransform& camera_from_world, double distance_m) {
    const RigidTransform world_from_camera = camera_from_world.inverse();
    return {world_from_camera.translation(), world_from_camera * Vector3d(0, 0, distance_m)};
}

RigidTransform pose_of_view(const CameraView& view) {
    return camera_looking_along(view.eye_m, (view.target_m - view.eye_m).normalized());
}

CameraView turned(const CameraView& view, double left_rad, double up_rad) {
    constexpr double steepest_rad = 1.55;  // a degree before straight down
    const Vector3d from_target_m = view.eye_m - view.target_m;
    const double distance_m = from_target_m.norm();
    const double azimuth = std::atan2(from_target_m.y(), from_target_m.x()) - left_rad;
    const double elevation = std::asin(std::clamp(from_target_m.z() / distance_m, -1.0, 1.0)) + up_rad;
    const double held = std::clamp(elevation, -steepest_rad, steepest_rad);
    const Vector3d direction(std::cos(held) * std::cos(azimuth), std::cos(held) * std::sin(azimuth), std::sin(held));
    return {view.target_m + distance_m * direction, view.target_m};
}

CameraView shifted(const CameraView& view, double right_m, double up_m) {
    const Eigen::Matrix3d world_from_camera = pose_of_view(view).linear().transpose();
    const Vector3d by_m = right_m * world_from_camera.col(0) - up_m * world_from_camera.col(1);
    return {view.eye_m + by_m, view.target_m + by_m};
}

CameraView at_distance(const CameraView& view, double factor) {
    constexpr double nearest_m = 0.01, farthest_m = 1e5;
    const Vector3d from_target_m = view.eye_m - view.target_m;
    const double distance_m = std::clamp(from_target_m.norm() * factor, nearest_m, farthest_m);
    return {view.target_m + distance_m * from_target_m.normalized(), view.target_m};
}

}  // namespace matchlight
