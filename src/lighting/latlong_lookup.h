// Looking lat-long images up between their pixels, and turning them about the vertical.
#pragma once

#include <array>

#include <Eigen/Core>

#include "core/image.h"

namespace matchlight {

/// The pixels of a lat-long image around a direction, over the seam and clamped at the poles, and their shares.
struct LatlongTaps {
    std::array<int, 2> x, y;
    double across, down;  // how far from the first of each to the second

    LatlongTaps(const Eigen::Vector3d& towards, int width, int height);
    double share(int i, int j) const { return (i != 0 ? across : 1 - across) * (j != 0 ? down : 1 - down); }
    int nearest_x() const { return x[across >= 0.5 ? 1 : 0]; }
    int nearest_y() const { return y[down >= 0.5 ? 1 : 0]; }
};

/// Turned counter-clockwise seen from above and times `gain`, whatever its channels hold: each pixel lies between two,
/// and every row keeps its sum. What a float cannot hold is the largest that it can.
ImageF turned_latlong(const ImageF& latlong, double rotation_deg, double gain = 1);

}  // namespace matchlight
