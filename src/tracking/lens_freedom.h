// Which parameters of a calibrated lens a clip knows better than its calibration.
#pragma once

#include <array>
#include <span>

#include "tracking/shared_normal.h"

namespace matchlight {

/// What the calibration's file says of its uncertainty, or what an ordinary calibration leaves open: from a dozen
/// photographs of a board, 0.2 % of the focal length and of the width for the principal point (Zhang 2000, A Flexible
/// New Technique for Camera Calibration, sec. 5), and as much of k1 and k2 as moves the picture's edge by a pixel or
/// two. The ratio of the focal lengths, which distance and tilt do not touch, is known four times better.
LensPrior calibration_prior(const Camera& camera);

/// Principal point, focal lengths and radial terms are set free pair by pair, the most telling first, where the clip
/// (i) knows them ten times better than the calibration; (ii) fits better by more than two for each parameter in χ²
/// (Akaike 1974, A New Look at the Statistical Model Identification); (iii) is not contradicted by as much in stretches
/// of it that are predicted from the others. `blocks` hold what the stretches say of `columns`, which hold all of the
/// lens; `freedom` and `model` give what is known beforehand.
std::array<bool, lens_parameter_count> choose_lens_freedom(std::span<const SharedNormal> blocks,
                                                           const SharedColumns& columns, const ClipModel& model,
                                                           const ModelFreedom& freedom);

}  // namespace matchlight
