// What the real surface sends out, gathered from many frames of the clip on a grid of its plane.
#pragma once

#include <Eigen/Geometry>

#include "core/image.h"

namespace matchlight {

/// Texel (i, j) covers its cell of the rectangle; row 0 has the smallest y, column 0 the smallest x. Texels are square.
struct GatheredSurface {
    ImageF radiance;                  // RGB in probe units, not premultiplied; A = how well it is known, 0 to 1
    ImageF clipped;                   // 1 channel: 1 where some channel is known only from below, else 0
    Eigen::AlignedBox2d rectangle_m;  // world x and y
    double texel_m() const { return rectangle_m.sizes().x() / radiance.width(); }
};

}  // namespace matchlight
