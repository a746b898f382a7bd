// The axis flips, rotations and projections that transforms.h names.
#include "core/transforms.h"

#include <cmath>
#include <numbers>

namespace matchlight {

Eigen::Matrix3d world_from_model_axes() {
    Eigen::Matrix3d axes;
    axes << 1, 0, 0,  //
        0, 0, -1,     //
        0, 1, 0;
    return axes;
}

Eigen::Matrix3d rotation_from_degrees(const Eigen::Vector3d& rotate_deg) {
    const Eigen::Vector3d radians = rotate_deg * (std::numbers::pi / 180.0);
    return (Eigen::AngleAxisd(radians.z(), Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(radians.y(), Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(radians.x(), Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
}

Eigen::Matrix3d detector_from_tag_axes() {
    return Eigen::Vector3d(1, -1, -1).asDiagonal();
}

Eigen::Matrix<double, 3, 4> tag_corners_m(double size_m) {
    const double h = size_m / 2;
    Eigen::Matrix<double, 3, 4> corners;
    corners << -h, h, h, -h,  //
        -h, -h, h, h,         //
        0, 0, 0, 0;
    return corners;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

RigidTransform camera_looking_along(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& forward) {
    // 1e-6: beyond it the horizon's direction would be rounding.
    const bool is_vertical = forward.cross(Eigen::Vector3d::UnitZ()).norm() < 1e-6;
    const Eigen::Vector3d up = is_vertical ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = forward.cross(up).normalized();
    RigidTransform world_from_camera = RigidTransform::Identity();
    world_from_camera.linear() << right, forward.cross(right), forward;
    world_from_camera.translation() = eye_m;
    return world_from_camera.inverse();
}

Eigen::Matrix4d clip_from_camera(const PinholeView& view) {
    // Pixel (u, v) spans [u − ½, u + ½]; the viewport spans [origin − ½, origin − ½ + size].
    const double centre_x = view.cx - view.origin_x + 0.5;
    const double centre_y = view.cy - view.origin_y + 0.5;
    Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
    clip(0, 0) = 2 * view.fx / view.width;
    clip(0, 2) = 2 * centre_x / view.width - 1;
    clip(1, 1) = -2 * view.fy / view.height;
    clip(1, 2) = 1 - 2 * centre_y / view.height;
    // Reversed z with the far plane at infinity (NUMERICS: 9e-5 m of error at 1 km in float): depth = near / z.
    clip(2, 3) = view.near_m;
    clip(3, 2) = 1;
    return clip;
}

bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance) {
    if (!matrix.allFinite()) return false;
    const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
    const Eigen::RowVector4d last(0, 0, 0, 1);
    return (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < tolerance &&
           rotation.determinant() > 0 && (matrix.row(3) - last).cwiseAbs().maxCoeff() < tolerance;
}

}  // namespace matchlight
