// What the wave nature of light makes of a bright point: the far-field diffraction pattern of the lens' aperture.
//
// After Kakimoto, Matsuoka, Nishita, Naemura, Harashima 2005, "Glare Generation Based on Wave Optics", and Ritschel,
// Ihrke, Frisvad, Coppens, Myszkowski, Seidel 2009, "Temporal Glare: Real-Time Dynamic Simulation of the Scattering in
// the Human Eye": Fraunhofer diffraction, |FFT(aperture)|², for each wavelength λ as wide as λ. Deviations: light
// within the first dark ring of a round aperture stays where it was, so it is no glare and left out; so are the far
// reaches, since no frame holds them. What remains is scaled to unit energy in each channel: the strength of
// diffraction is the energy that it adds over that of the light above the threshold.
#pragma once

#include "core/image.h"
#include "render/effects/kernel.h"
#include "scene/effects.h"

namespace matchlight {

/// Knobs of its accuracy.
struct DiffractionQuality {
    int aperture_side = 1024;  // texels of the aperture's image, a power of two; more reach further and alias less
    int wavelengths = 32;
    double samples = 1;  // of the pattern, along a side of a sample of the aperture's power spectrum
};

/// Wavelength at which sizes are stated.
inline constexpr double diffraction_wavelength_nm = 550;
/// Radius of the first dark ring of a round aperture, in wavelengths over the aperture's diameter (Airy 1835).
inline constexpr double airy_ring = 1.2197;
/// How far the pattern is followed, in radii of that ring; it fades out over the last quarter.
inline constexpr double reach_in_airy_radii = 32;

/// Radius of the first dark ring on the sensor.
double airy_radius_px(double f_number, double pixel_pitch_um);
/// How far light is carried, in frame pixels.
double diffraction_reach_px(const GlareSettings& settings, int frame_height);

/// The light that each texel gets from a point in the middle of the middle texel, RGB;
/// each channel sums to 1, with
/// what the grid loses. Its side is odd, and it is point-symmetric. Throws InputError as make_aperture_image() does.
Image<double> make_diffraction_kernel(const ApertureSettings& aperture, double reach_px, const KernelGrid& grid,
                                      const DiffractionQuality& quality = {});

}  // namespace matchlight
