// Readings of blur, as the solve of focus and shutter takes them.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

/// The blur across edges of a tag at one depth.
struct BlurReading {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  // in the plate, in widths of it
    double inverse_depth = 0;                         // 1/m, along the optical axis
    Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
    double motion_px = 0;     // a frame, across the edges
    double variance_px2 = 0;  // of the Gaussian that fits best, without the pixel's box
};

/// Those of one tag in one frame, in the same order in every frame. A tag appears once a frame, frames ascend.
struct TagBlurReadings {
    std::size_t frame = 0;  // index into the clip's frames
    int id = 0;             // of the tag
    std::vector<BlurReading> readings;
    Eigen::MatrixXd covariance;  // of the variances
};

}  // namespace matchlight
