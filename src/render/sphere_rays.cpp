// Frustum tests by the corners of boxes, and what shaders need to know of rays.
#include "render/sphere_rays.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace matchlight {

namespace {

Eigen::Vector3d corner_of(const SphereCell& cell, int which) {
    Eigen::Vector3d corner;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        corner[axis] = ((which >> axis) & 1) != 0 ? cell.high_m[at] : cell.low_m[at];
    }
    return corner;
}

/// The vectors square to parallel rays that make a step of the picture's axes, and the direction of the rays.
Eigen::Matrix3d parallel_rays(const Eigen::Matrix4d& clip_from_model) {
    const Eigen::Vector3d x = clip_from_model.row(0).head<3>(), y = clip_from_model.row(1).head<3>();
    const Eigen::Vector3d depth = clip_from_model.row(2).head<3>();
    Eigen::Vector3d direction = x.cross(y).normalized();
    if (depth.dot(direction) > 0) direction = -direction;
    Eigen::Matrix3d axes;
    axes << x.transpose(), y.transpose(), direction.transpose();
    Eigen::Matrix3d rays = axes.inverse();
    rays.col(2) = direction;
    return rays;
}

Eigen::Matrix3d perspective_axes(const Eigen::Matrix4d& clip_from_model) {
    Eigen::Matrix3d axes;
    axes << clip_from_model.row(0).head<3>(), clip_from_model.row(1).head<3>(), clip_from_model.row(3).head<3>();
    return axes;
}

}  // namespace

SphereRays::SphereRays(const SphereProjection& view, const Eigen::Matrix4d& world_from_model)
    : clip_from_model_(view.clip_from_world * world_from_model),
      ray_from_ndc_(view.is_parallel ? parallel_rays(clip_from_model_)
                                     : Eigen::Matrix3d(perspective_axes(clip_from_model_).inverse())),
      width_(view.width),
      height_(view.height),
      is_parallel_(view.is_parallel) {}

Eigen::Vector3d SphereRays::origin() const {
    const Eigen::Vector3d offset(clip_from_model_(0, 3), clip_from_model_(1, 3), clip_from_model_(3, 3));
    return -(ray_from_ndc_ * offset);
}

bool SphereRays::is_long_lens() const {
    if (is_parallel_) return false;
    // What a direction is rounded by, thrice, is then more than a fiftieth of a pixel.
    constexpr double narrow = 1e-5;
    const double pixel = std::min(2 * ray_from_ndc_.col(0).norm() / width_, 2 * ray_from_ndc_.col(1).norm() / height_);
    return pixel < narrow * ray_from_ndc_.col(2).norm();
}

void SphereRays::set(Program& program) const {
    const Eigen::Matrix4f clip_from_model = clip_from_model_.cast<float>();
    const Eigen::Matrix3f ray_from_ndc = ray_from_ndc_.cast<float>();
    program.set("clip_from_model", clip_from_model);
    program.set("ray_from_ndc", ray_from_ndc);
    const bool is_long = is_long_lens();
    program.set("is_long_lens", is_long);
    if (is_long) {
        program.set("clip_from_model_low",
                    Eigen::Matrix4f((clip_from_model_ - clip_from_model.cast<double>()).cast<float>()));
        program.set("ray_from_ndc_low", Eigen::Matrix3f((ray_from_ndc_ - ray_from_ndc.cast<double>()).cast<float>()));
    }
    program.set("picture_px", Eigen::Vector2f(static_cast<float>(width_), static_cast<float>(height_)));
    if (is_parallel_) {
        program.set("depth_from_model", Eigen::Vector3f(clip_from_model_.row(2).head<3>().transpose().cast<float>()));
        return;
    }
    const Eigen::Vector3d eye = origin();
    const Eigen::Vector3f high = eye.cast<float>();
    program.set("eye_high", high);
    program.set("eye_low", Eigen::Vector3f((eye - high.cast<double>()).cast<float>()));
    program.set("near_plane_m", clip_from_model_(2, 3));
}

double SphereRays::nearest_depth(const SphereCell& cell) const {
    double nearest = 0;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector4d clip = clip_from_model_ * corner_of(cell, i).homogeneous();
        if (clip.w() <= 0) return std::numeric_limits<double>::infinity();
        nearest = std::max(nearest, clip.z() / clip.w());
    }
    return nearest;
}

SphereRays::Place SphereRays::place(const SphereCell& cell) const {
    constexpr int planes = 6;
    std::array<int, planes> outside{};
    double nearest_w = std::numeric_limits<double>::max();
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector4d clip = clip_from_model_ * corner_of(cell, i).homogeneous();
        const std::array<double, planes> inside{clip.w() + clip.x(), clip.w() - clip.x(), clip.w() + clip.y(),
                                                clip.w() - clip.y(), clip.w() - clip.z(), clip.z()};
        for (std::size_t plane = 0; plane < planes; ++plane) outside[plane] += inside[plane] < 0 ? 1 : 0;
        nearest_w = std::min(nearest_w, clip.w());
    }
    if (std::ranges::find(outside, 8) != outside.end()) return Place::outside;
    if (std::ranges::any_of(outside, [](int corners) { return corners > 0; }) || nearest_w <= 0) return Place::large;
    constexpr double largest_point_px = 56;  // OpenGL promises only a point of one pixel; all drivers draw 64
    return 2 * radius_px(cell, nearest_w) < largest_point_px ? Place::small : Place::large;
}

CellInPicture SphereRays::in_picture(const SphereCell& cell) const {
    const Eigen::Array2d size_px(width_, height_);
    const Eigen::AlignedBox2d picture(Eigen::Vector2d::Zero(), size_px.matrix());
    CellInPicture seen;
    double sum_w = 0;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector4d clip = clip_from_model_ * corner_of(cell, i).homogeneous();
        if (clip.w() <= std::max(clip.z(), 0.0)) return {picture, 0};
        const Eigen::Array2d ndc(clip.x() / clip.w(), -clip.y() / clip.w());
        seen.box_px.extend((0.5 * (ndc + 1) * size_px).matrix());
        sum_w += clip.w();
    }
    seen.box_px = seen.box_px.intersection(picture);
    const double px_per_m = 0.5 * clip_from_model_.row(0).head<3>().norm() * width_ / (sum_w / 8);
    const double radius_px = px_per_m * cell.largest_radius_m;
    seen.discs_px = std::numbers::pi * radius_px * radius_px * cell.count;
    return seen;
}

double SphereRays::radius_px(const SphereCell& cell, double nearest_w) const {
    // Within the picture a place moves by no more than this with a metre.
    const double along_w = clip_from_model_.row(3).head<3>().norm();
    const double ndc_per_m =
        (std::max(clip_from_model_.row(0).head<3>().norm(), clip_from_model_.row(1).head<3>().norm()) + along_w) /
        nearest_w;
    return 0.5 * ndc_per_m * cell.largest_radius_m * std::max(width_, height_);
}

double SphereRays::largest_radius_px(const SphereCell& cell) const {
    double nearest_w = std::numeric_limits<double>::max();
    for (int i = 0; i < 8; ++i)
        nearest_w = std::min(nearest_w, clip_from_model_.row(3).dot(corner_of(cell, i).homogeneous()));
    return radius_px(cell, nearest_w);
}

}  // namespace matchlight
