// STMaps of the lens: where each pixel of one picture lies in another, as compositing programs read them.
#pragma once

#include <cstdint>
#include <optional>

#include "calibration/camera.h"
#include "core/image.h"
#include "exchange/camera_track.h"

namespace matchlight {

/// The plate as a lens without distortion would have filmed it, wider by the overscan on all sides.
struct UndistortedPicture {
    PinholePicture pinhole;          // its own size and principal point
    int margin_x = 0, margin_y = 0;  // pixels that the plate's frame lies in from the left and the top
    double overscan = 1;             // of the width
    std::int64_t uncovered = 0;      // pixels of the plate whose light lies outside, or nowhere
};

/// Largest overscan: wider lenses lose their corners (`uncovered`).
inline constexpr double largest_overscan = 4;

/// `overscan` ≥ 1 multiplies the plate's size; absent: as much as the whole plate needs, up to the largest. Sizes grow
/// by the same whole number of pixels on both sides, and keep the plate's scale (fx, fy).
UndistortedPicture undistorted_picture(const Camera& camera, std::optional<double> overscan, bool centred);

/// A map of 3 channels: u, v, and 1 where the map is good. u and v run from 0 to 1 over the source, from its lower left
/// corner, pixel centres at (i + ½)/n; they go on beyond where the source is looked for outside. Where no pixel of the
/// source answers (the lens model folds back or does not reach), all three are 0 and −1: u = v = −1, good = 0.
struct Stmap {
    ImageF map;
    std::int64_t unreachable = 0;  // pixels so marked
};

/// Makes the undistorted picture from the plate: of its size, pointing into the plate.
Stmap undistort_map(const Camera& camera, const UndistortedPicture& picture);
/// Makes a plate from an undistorted picture: of the plate's size, pointing into the picture.
Stmap redistort_map(const Camera& camera, const UndistortedPicture& picture);

}  // namespace matchlight
