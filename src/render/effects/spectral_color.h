// Colours of wavelengths in linear Rec.709.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace matchlight {

/// What eyes see, but for the faintest ends (below 0.1 % of the peak).
inline constexpr double shortest_wavelength_nm = 380;
inline constexpr double longest_wavelength_nm = 770;

/// Colour of light of one wavelength and unit power, linear Rec.709; channels may be negative. Colour matching by the
/// fit of Wyman, Sloan & Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions".
Eigen::Vector3d spectral_color_rec709(double wavelength_nm);

struct SpectralSample {
    double wavelength_nm = 0;
    Eigen::Vector3d color_rec709;
};
/// The middles of `count` equal parts of the spectrum, whose colours sum to white (1, 1, 1).
std::vector<SpectralSample> white_spectrum(int count);

}  // namespace matchlight
