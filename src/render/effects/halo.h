// The lenticular halo: coloured rings around bright lights, made by the fibres of the eye's own lens.
//
// Spencer, Shirley, Zimmerman, Greenberg 1995, "Physically-Based Glare Effects for Digital Images": light of wavelength
// λ goes to a ring of 3° · λ / 568 nm around the light, exp(−(θ − 3 λ/568)²) in degrees: 2.0° for violet to 4.1° for
// red. Deviations: cut off 3° from the ring's middle, where less than 1/8000 is left; unit energy in each channel, so
// that the halo's strength is the energy that it adds over that of the light above the threshold.
#pragma once

#include "core/image.h"
#include "render/effects/kernel.h"

namespace matchlight {

struct HaloQuality {
    int wavelengths = 32;
    double samples = 8;  // along a ring's standard deviation
};

/// How far the halo reaches in a picture with this focal length, in frame pixels.
double halo_reach_px(double focal_px);

/// The light that each texel gets from a point in the middle of the middle one, RGB; each channel sums to 1. Angles are
/// those around the picture's middle.
Image<double> make_halo_kernel(double focal_px, const KernelGrid& grid, const HaloQuality& quality = {});

}  // namespace matchlight
