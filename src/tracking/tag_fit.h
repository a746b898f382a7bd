// Refines a detected tag to hundredths of a pixel by fitting its known image, in linear light, through the lens.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "core/image.h"
#include "tracking/blurred_pattern.h"
#include "tracking/edge_blur.h"
#include "tracking/tag_detector.h"
#include "tracking/tag_pixels.h"

namespace matchlight {

using TagCorners = Eigen::Matrix<double, 2, 4>;     // in tag_corners_m's order
using TagCovariance = Eigen::Matrix<double, 8, 8>;  // of (x0, y0, x1, y1, …)

/// Where a tag is in one frame.
struct TagObservation {
    int id = 0;
    TagCorners corners_normalized;    // on the plane z = 1 of the camera: the lens is undone
    TagCovariance covariance;         // of corners_normalized
    TagCorners corners_px;            // in the plate
    double side_px = 0;               // mean length of the sides, lens undone
    std::array<double, 2> blur_px{};  // standard deviation across vertical and horizontal edges of the sheet
    /// The same blur in the plate: covariance (px²) along x and y, without the pixel's own box.
    Eigen::Matrix2d blur_covariance_px2 = Eigen::Matrix2d::Zero();
    TagBlur edge_blur;       // the same from near to far, with standard errors
    double contrast = 0;     // light of paper minus ink
    double correlation = 0;  // of the light with the fitted image, 0..1
    double decision_margin = 0;
    bool refined = false;  // by the fit; otherwise the library's corners
    /// From a fit of the whole rig to the frame, through the motion of the exposure: the corners are those at
    /// mid-exposure by one pose, and the same errors are in all tags of the frame.
    bool joint = false;
    std::optional<Eigen::Vector2d> streak_px;  // of a joint fit: what its middle travels during the exposure, or back
};

/// The observation with the fitted map from plate to tag grid, for whoever samples the tag.
struct TagImageFit {
    TagObservation observation;
    /// Homogeneous grid coordinates (a, b, 1)·w of normalised ones.
    Eigen::Matrix3d grid_from_normalized;
    /// Pixels a grid cell spans along its axes, at the tag's centre.
    std::array<double, 2> cell_px{};
};

struct TagFitOptions {
    /// Pixels near edges, evenly spread where there are more; the time goes with them. 3000 is where more no longer
    /// lower the error: neighbours share the coding's noise.
    std::size_t most_pixels = 3000;
    double start_error_px = 0;  // what the corners of a prediction may be off; detected ones are within the blur
    bool edge_blur = true;      // measure TagObservation::edge_blur
};

/// Fits homography (8), blur (3) and planes of light for paper and ink (6) to the light near the tag's edges, weighted
/// robustly, from the corners of `detection`. nullopt when the pixels do not look like that tag: a decoy. When they do
/// but the fit does not hold (too blurred, too small), the detection's corners come back with a wide covariance.
std::optional<TagImageFit> fit_tag(const FitSource& source, const TagPattern& tag, const TagDetection& detection,
                                   const TagFitOptions& options = {});

/// The detection's own corners, unfitted, with the blur of an ordinary sharp picture. nullopt where the lens does not
/// reach.
std::optional<TagImageFit> detected_corners(const LensGrid& lens, const TagPattern& tag, const TagDetection& detection);

}  // namespace matchlight
