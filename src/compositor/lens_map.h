// The lens of the footage as the GPU reads it: undistorted directions on a coarse grid of plate pixels.
#pragma once

#include <Eigen/Geometry>

#include "calibration/camera.h"
#include "core/image.h"

namespace matchlight {

/// Normalised camera coordinates (x/z, y/z) at every `spacing`-th pixel, starting at (−spacing, −spacing). Between
/// nodes a bilinear look-up is off by at most spacing²/8 times the second derivative of the inverse lens: 0.005 px in
/// the corners of a 1,920-pixel frame with k1 = −0.28, a tenth of the registration error that is aimed at.
struct LensMap {
    static constexpr int spacing = 4;
    ImageF nodes;                           // 2 channels; NaN where the lens model does not reach
    Eigen::AlignedBox2d normalized_bounds;  // of all nodes that are finite

    /// The same bilinear look-up as shaders/common/lens_map.glsl: beyond the grid its outermost cells go on straight.
    Eigen::Vector2d normalized(double x, double y) const;
};

LensMap make_lens_map(const Camera& camera);

}  // namespace matchlight
