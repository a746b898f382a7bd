// The double-precision references of streak glare: exact exponentials, and the classic diagonals.
#pragma once

#include "report/bright_reference.h"
#include "scene/effects.h"

namespace matchlight {

/// `bright_light` (reference_bright_light, over a whole frame) drawn out by each streak of streaks_model.h: the
/// integral of the exponential times the Gaussian across it has a closed form, which is taken at every pixel within
/// `cut_sigmas` of the streak and normalised. Compare with twice `cut_sigmas` to see what is cut.
ImageD reference_streaks(const ImageD& bright_light, const GlareSettings& settings, double cut_sigmas = 6);

/// The classic model in its own converged form: its square, every tap of its diagonals, its bilinear interpolation.
ImageD reference_classic_streaks(const ImageD& bright_light, const GlareSettings& settings);

}  // namespace matchlight
