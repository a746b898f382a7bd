// The double-precision reference of the lenticular halo, from the paper's formula.
#pragma once

#include "core/image.h"

namespace matchlight {

struct HaloReferenceOptions {
    double focal_px = 1;
    double strength = 1;
    int wavelengths = 128;
    int points = 4;  // along a pixel's side
};

/// The light that the halo adds to a frame; `bright_light` is D of the bright pass for every pixel, RGB, signed.
/// Spencer, Shirley, Zimmerman, Greenberg 1995; see render/effects/halo.h for the deviations, which are the same here.
Image<double> reference_halo(const Image<double>& bright_light, const HaloReferenceOptions& options);

}  // namespace matchlight
