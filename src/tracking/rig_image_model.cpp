// Homographies along the exposure, and the pattern summed over them.
#include "tracking/rig_image_model.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace matchlight {

namespace {

/// From normalised image coordinates to the grid's, homogeneous with a third coordinate above zero in front of the
/// camera.
Eigen::Matrix3d grid_from_normalized(const PlacedSheet& sheet, const RigidTransform& camera_from_world) {
    const RigidTransform camera_from_tag = camera_from_world * sheet.world_from_tag;
    Eigen::Matrix3d camera_from_plane;
    camera_from_plane << camera_from_tag.linear().col(0), camera_from_tag.linear().col(1),
        camera_from_tag.translation();
    const double middle = sheet.printed.cells / 2.0;
    Eigen::Matrix3d grid_from_plane;
    grid_from_plane << 1 / sheet.cell_m(), 0, middle, 0, -1 / sheet.cell_m(), middle, 0, 0, 1;
    return grid_from_plane * camera_from_plane.inverse();
}

bool shows_its_face(const PlacedSheet& sheet, const RigidTransform& camera_from_world) {
    const RigidTransform camera_from_tag = camera_from_world * sheet.world_from_tag;
    const Eigen::Vector3d centre = camera_from_tag.translation();
    const Eigen::Matrix<double, 3, 4> corners = camera_from_tag * tag_corners_m(1.3 * sheet.size_m);
    return camera_from_tag.linear().col(2).dot(centre) < 0 && corners.row(2).minCoeff() > 1e-3;
}

}  // namespace

SheetImage::SheetImage(const PlacedSheet& sheet, const MovingCamera& camera, const Camera& lens)
    : sheet_(sheet), focal_px_(std::sqrt(lens.fx * lens.fy)), blur_px_(camera.blur_px) {
    in_view_ = shows_its_face(sheet, camera.at(-0.5)) && shows_its_face(sheet, camera.at(0)) &&
               shows_its_face(sheet, camera.at(0.5));
    if (!in_view_) return;
    const Eigen::Vector3d centre = sheet.world_from_tag.translation();
    const auto centre_at = [&](double time) -> Eigen::Vector2d { return (camera.at(time) * centre).hnormalized(); };
    streak_px_ = (centre_at(0.5) - centre_at(-0.5)).norm() * focal_px_;
    tag_from_camera_ = (camera.camera_from_world * sheet.world_from_tag).inverse();
    // Steps of two pixels vanish in the blur of any picture; a long streak over wide cells needs no more than eight of
    // them a cell.
    const double cell_px = sheet.cell_m() * focal_px_ / (camera.camera_from_world * centre).z();
    const double step_px = std::max(2.0, cell_px / 8);
    constexpr double most_steps = 64;
    const auto steps = static_cast<std::size_t>(std::clamp(std::ceil(streak_px_ / step_px), 1.0, most_steps));
    for (std::size_t i = 0; i < steps; ++i) {
        times_.push_back((static_cast<double>(i) + 0.5) / static_cast<double>(steps) - 0.5);
        grid_from_normalized_.push_back(grid_from_normalized(sheet, camera.at(times_.back())));
    }
    for (const double time : {-0.5, 0.5, 0.0}) {
        grid_from_normalized_.push_back(grid_from_normalized(sheet, camera.at(time)));
    }
}

bool SheetImage::sees_only_cells(const Eigen::Vector2d& normalized) const {
    for (std::size_t i = times_.size(); i < grid_from_normalized_.size(); ++i) {
        const Eigen::Vector3d grid = grid_at(i, normalized);
        if (!(grid.z() > 0) || !sheet_.pattern.is_known(grid.x() / grid.z(), grid.y() / grid.z())) return false;
    }
    return true;
}

void SheetImage::locate(SheetPixel& pixel) const {
    const Eigen::Matrix3d& h = grid_from_normalized_.back();
    const Eigen::Vector3d grid = h * pixel.normalized.homogeneous();
    const double a = grid.x() / grid.z(), b = grid.y() / grid.z();
    const Eigen::Vector2d gradient_a = (h.row(0).head<2>() - a * h.row(2).head<2>()) / (grid.z() * focal_px_);
    const Eigen::Vector2d gradient_b = (h.row(1).head<2>() - b * h.row(2).head<2>()) / (grid.z() * focal_px_);
    pixel.cells_per_px_a = gradient_a.norm();
    pixel.cells_per_px_b = gradient_b.norm();
    pixel.axes_cosine = gradient_a.dot(gradient_b) / (pixel.cells_per_px_a * pixel.cells_per_px_b);
}

bool SheetImage::at(const SheetPixel& pixel, SheetSample& sample) const {
    constexpr double pixel_variance = 1.0 / 12;
    const std::size_t steps = times_.size();
    const double count = static_cast<double>(steps);
    const Eigen::Vector3d begin = grid_at(steps, pixel.normalized), end = grid_at(steps + 1, pixel.normalized),
                          middle = grid_at(steps + 2, pixel.normalized);
    if (!(begin.z() > 0 && end.z() > 0 && middle.z() > 0)) return false;
    const Eigen::Vector2d step = (end.hnormalized() - begin.hnormalized()) / count;
    const double still_a = blur_px_ * pixel.cells_per_px_a, still_b = blur_px_ * pixel.cells_per_px_b;
    const AxisFootprint along_a{pixel.cells_per_px_a, std::sqrt(still_a * still_a + step.x() * step.x() / 12)};
    const AxisFootprint along_b{pixel.cells_per_px_b, std::sqrt(still_b * still_b + step.y() * step.y() / 12)};
    const double covariance =
        (blur_px_ * blur_px_ + pixel_variance) * pixel.axes_cosine * pixel.cells_per_px_a * pixel.cells_per_px_b +
        step.x() * step.y() / 12;
    double paper = 0, by_blur_a = 0, by_blur_b = 0;
    Eigen::Matrix<double, 2, 3> by_grid = Eigen::Matrix<double, 2, 3>::Zero();
    for (std::size_t i = 0; i < steps; ++i) {
        const Eigen::Vector3d grid = grid_at(i, pixel.normalized);
        const PatternSample seen =
            sheet_.pattern.at(grid.x() / grid.z(), grid.y() / grid.z(), along_a, along_b, covariance);
        paper += seen.paper;
        const Eigen::Vector2d by(seen.by_a, seen.by_b);
        by_grid.col(0) += by;
        by_grid.col(1) += times_[i] * by;
        // The mean of ½·time² over the step: also a camera that only turns back has one.
        by_grid.col(2) += 0.5 * (times_[i] * times_[i] + 1 / (12 * count * count)) * by;
        by_blur_a += seen.by_blur_a;
        by_blur_b += seen.by_blur_b;
    }
    sample.paper = paper / count;
    sample.by_log_blur =
        (by_blur_a * still_a * still_a / along_a.blur + by_blur_b * still_b * still_b / along_b.blur) / count;
    sample.sheet = middle.hnormalized() / (0.5 * sheet_.printed.cells) - Eigen::Vector2d::Ones();
    add_derivatives(pixel, by_grid / count, sample);
    return true;
}

/// How the hit point on the plane moves with the pose: the world point X that a ray meets moves by
/// −δ + d (n·δ)/(n·d), δ = ω × X + v, for the ray's direction d. That of mid-exposure serves the whole of it.
void SheetImage::add_derivatives(const SheetPixel& pixel, const Eigen::Matrix<double, 2, 3>& by_grid,
                                 SheetSample& sample) const {
    const Eigen::Vector3d origin = tag_from_camera_.translation();
    const Eigen::Vector3d direction = tag_from_camera_.linear() * pixel.normalized.homogeneous();
    const Eigen::Vector3d hit = origin - origin.z() / direction.z() * direction;
    const Eigen::Vector3d world = sheet_.world_from_tag * hit;
    const double cells_per_m = 1 / sheet_.cell_m();
    const Eigen::Vector3d row_a =
        sheet_.world_from_tag.linear() * Eigen::Vector3d(-1, 0, direction.x() / direction.z()) * cells_per_m;
    const Eigen::Vector3d row_b =
        sheet_.world_from_tag.linear() * Eigen::Vector3d(0, 1, -direction.y() / direction.z()) * cells_per_m;
    PoseStep a_by_pose, b_by_pose;
    a_by_pose << world.cross(row_a), row_a;
    b_by_pose << world.cross(row_b), row_b;
    sample.by_pose = by_grid(0, 0) * a_by_pose + by_grid(1, 0) * b_by_pose;
    sample.by_motion = by_grid(0, 1) * a_by_pose + by_grid(1, 1) * b_by_pose;
    sample.by_bend = by_grid(0, 2) * a_by_pose + by_grid(1, 2) * b_by_pose;
}

}  // namespace matchlight
