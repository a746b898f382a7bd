// The double-precision references of bloom: its mixture of Gaussians, and the classic chain of squares.
#pragma once

#include "report/bright_reference.h"
#include "scene/effects.h"

namespace matchlight {

/// `bright_light` (reference_bright_light, over a whole frame) spread by the Gaussians of bloom_model.h at every pixel,
/// times the strength; each ends at `cut_sigmas` of its own standard deviations and has a unit sum. What 6 leaves out
/// is below 1e-8 of the light: compare with 12 to see it.
ImageD reference_bloom(const ImageD& bright_light, const BloomSettings& settings, double cut_sigmas = 6);

/// The classic model in its own converged form: its squares, its Gaussians uncut, its bilinear interpolation.
ImageD reference_classic_bloom(const ImageD& bright_light, const BloomSettings& settings, double cut_sigmas = 6);

/// One Gaussian of given standard deviations along both axes, of unit sum, dark outside of the image.
ImageD gaussian_blurred(const ImageD& image, double sigma_x, double sigma_y, double cut_sigmas);

}  // namespace matchlight
