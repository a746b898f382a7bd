// Undoing the lens for millions of pixels: exact inversions on a grid, interpolated between.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"

namespace matchlight {

/// Normalised image coordinates (z = 1) of any pixel of the frame. Between grid points, 4 px apart, the correction of
/// the lens is interpolated linearly; for |k1| = 0.3 at f = 0.8 widths that is within 1e-3 px of Newton's method.
class LensGrid {
public:
    explicit LensGrid(const Camera& camera);

    const Camera& camera() const { return camera_; }

    /// NaN where the lens model does not reach the pixel. Pixels a little outside the frame are continued.
    Eigen::Vector2d normalized_from_pixel(double x, double y) const;

private:
    Camera camera_;
    bool pinhole_ = false;
    int columns_ = 0, rows_ = 0;
    std::vector<Eigen::Vector2d> correction_;  // exact normalised minus pinhole normalised
};

}  // namespace matchlight
