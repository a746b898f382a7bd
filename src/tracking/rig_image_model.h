// The picture of placed tags while the camera moves during the exposure.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/transforms.h"
#include "tracking/blurred_pattern.h"
#include "tracking/camera_pose.h"
#include "tracking/lens_grid.h"

namespace matchlight {

using PoseStep = Eigen::Matrix<double, 6, 1>;  // a perturbation: rotation vector, then translation, on the world side

/// A tag of the rig at its place.
struct PlacedSheet {
    int id = 0;
    double size_m = 0;
    RigidTransform world_from_tag = RigidTransform::Identity();
    TagPattern printed;
    BlurredPattern pattern{printed};

    double cell_m() const { return size_m / (printed.border_end - printed.border_begin); }
    /// Grid coordinates (a, b) of the sheet's plane, and back.
    Eigen::Vector2d grid_from_sheet(const Eigen::Vector2d& sheet_m) const {
        return {printed.cells / 2.0 + sheet_m.x() / cell_m(), printed.cells / 2.0 - sheet_m.y() / cell_m()};
    }
    Eigen::Vector3d sheet_from_grid(const Eigen::Vector2d& grid) const {
        return {(grid.x() - printed.cells / 2.0) * cell_m(), (printed.cells / 2.0 - grid.y()) * cell_m(), 0};
    }
};

/// Where the camera is at mid-exposure, how far it moves from the beginning of the exposure to its end, and the blur of
/// everything else (standard deviation, pixels; without the pixel's own box).
struct MovingCamera {
    RigidTransform camera_from_world = RigidTransform::Identity();
    PoseStep motion = PoseStep::Zero();
    double blur_px = 1;

    /// At `time` of the exposure, −½ … ½.
    RigidTransform at(double time) const { return perturbed(camera_from_world, time * motion); }
};

/// A pixel that sees a sheet. How the grid's cells are spaced there changes little while a fit moves.
struct SheetPixel {
    Eigen::Vector2d normalized = Eigen::Vector2d::Zero();
    double light = 0;
    double cells_per_px_a = 0, cells_per_px_b = 0, axes_cosine = 0;
};

/// Share of paper that a pixel collects over the exposure, with its derivatives.
struct SheetSample {
    double paper = 0;
    PoseStep by_pose = PoseStep::Zero(), by_motion = PoseStep::Zero();
    PoseStep by_bend = PoseStep::Zero();  // by what is added to the motion as ½·bend·time²
    double by_log_blur = 0;
    Eigen::Vector2d sheet = Eigen::Vector2d::Zero();  // grid coordinates from the middle, −1 … 1, at mid-exposure
};

/// One sheet through one moving camera. The path of a pixel over the grid is cut into steps; within each the pattern is
/// seen through the pixel's box and a Gaussian that holds the blur and, with the variance of its length, the step.
class SheetImage {
public:
    SheetImage(const PlacedSheet& sheet, const MovingCamera& camera, const Camera& lens);

    /// The sheet shows its face to the camera, in front of it, all through the exposure.
    bool in_view() const { return in_view_; }
    /// Pixels that the middle of the sheet travels.
    double streak_px() const { return streak_px_; }

    bool at(const SheetPixel& pixel, SheetSample& sample) const;
    /// Whether all that the pixel collects is known: it stays on the printed cells all through the exposure.
    bool sees_only_cells(const Eigen::Vector2d& normalized) const;
    /// Sets how the cells are spaced at the pixel.
    void locate(SheetPixel& pixel) const;

private:
    Eigen::Vector3d grid_at(std::size_t step, const Eigen::Vector2d& normalized) const {
        return grid_from_normalized_[step] * normalized.homogeneous();
    }
    /// Columns: Σ of the derivatives by the grid's coordinates, weighted by 1, time and ½·time².
    void add_derivatives(const SheetPixel& pixel, const Eigen::Matrix<double, 2, 3>& by_grid,
                         SheetSample& sample) const;

    const PlacedSheet& sheet_;
    double focal_px_, blur_px_;
    std::vector<double> times_;
    std::vector<Eigen::Matrix3d> grid_from_normalized_;  // at times_, then at the ends and the middle
    RigidTransform tag_from_camera_;                     // mid-exposure
    bool in_view_ = false;
    double streak_px_ = 0;
};

}  // namespace matchlight
