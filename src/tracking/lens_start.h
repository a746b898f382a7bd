// A lens for footage that comes without a calibration: a guess to look with, and where to begin from what was seen.
#pragma once

#include <vector>

#include "calibration/camera.h"
#include "tracking/lens_freedom.h"
#include "tracking/rig_solve.h"

namespace matchlight {

/// A pinhole with the picture's width for its focal length, square pixels, the axis in the middle: between a
/// telephone's and a normal lens.
Camera guessed_camera(int width, int height);

/// What is known of a lens that nobody calibrated: nothing of the focal length, pixels square to a thousandth, the axis
/// in the middle to half a percent of the width, radial terms of ordinary lenses.
LensPrior uncalibrated_prior(const Camera& camera);

/// The same corners in the plate, their normalised coordinates and covariances through another lens.
void express_with(const Camera& camera, const Camera& observed_with, std::vector<FrameObservations>& frames);

/// A focal length to begin with: from several between wide and long, rig, path and bundle are solved over a few dozen
/// frames with the lens free; the one that explains the corners best is taken. `frames` were observed with `guess`.
Camera find_lens(const std::vector<RigTag>& rig, const std::vector<FrameObservations>& frames, const Camera& guess);

}  // namespace matchlight
