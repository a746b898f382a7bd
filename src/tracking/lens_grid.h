// Undoing the lens for millions of pixels: exact inversions on a grid, interpolated between.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"

namespace matchlight {

/// Normalised image coordinates (z = 1) of any pixel of the frame. Between grid points a few pixels apart the
/// correction of the lens is interpolated linearly: within 1e-3 px of Newton's method for ordinary lenses.
class LensGrid {
public:
    explicit LensGrid(const Camera& camera);

    const Camera& camera() const { return camera_; }

    /// NaN where the lens model does not reach the pixel. Pixels a little outside the frame are continued.
    Eigen::Vector2d normalized_from_pixel(double x, double y) const;

private:
    Camera camera_;
    bool pinhole_ = false;
    int step_px_ = 4;
    int columns_ = 0, rows_ = 0;
    std::vector<Eigen::Vector2d> correction_;  // exact normalised minus pinhole normalised
};

}  // namespace matchlight
