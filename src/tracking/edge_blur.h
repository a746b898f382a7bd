// How blurred the edges of one tag are, from its near to its far side: what focus and shutter are found from.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "tracking/tag_minimiser.h"

namespace matchlight {

/// The blur across one of the two sets of parallel edges, in one strip of the tag's sheet at about one depth.
struct EdgeBlur {
    Eigen::Vector2d normalized;  // centre of what was measured, on the plane z = 1 of the camera
    Eigen::Vector2d normal;      // unit vector in the plate, across the edges
    /// Of the Gaussian that fits best, in plate pixels, without the pixel's own box. Of sharpened pictures it may be
    /// negative.
    double variance_px2 = 0;
};

struct TagBlur {
    std::vector<EdgeBlur> edges;
    Eigen::MatrixXd covariance;  // of the variances, px⁴
    double cell_px = 0;          // of the narrower side of a cell: blur wider than it is not measured well
};

/// Frees the blur of each strip in the fitted image, together with all else that was fitted (Gauss–Newton from
/// `state`). Strips run along lines of equal depth, which the homography knows: its denominator is proportional to
/// 1/depth. Empty where the tag's pixels do not carry it.
TagBlur measure_edge_blur(const TagImageModel& model, const TagFitState& state, const std::vector<TagPixel>& pixels,
                          double clipped_light, const Camera& camera);

}  // namespace matchlight
