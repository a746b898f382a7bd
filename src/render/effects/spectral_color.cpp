// Sums of Gaussian lobes, and the way from CIE XYZ to Rec.709.
#include "render/effects/spectral_color.h"

#include <cassert>
#include <cmath>

namespace matchlight {
namespace {

/// A Gaussian with two widths, given as reciprocals below and above its middle.
double lobe(double wavelength_nm, double middle_nm, double below, double above) {
    const double t = (wavelength_nm - middle_nm) * (wavelength_nm < middle_nm ? below : above);
    return std::exp(-t * t / 2);
}

}  // namespace

Eigen::Vector3d spectral_color_rec709(double wavelength_nm) {
    const double l = wavelength_nm;
    const Eigen::Vector3d xyz(0.362 * lobe(l, 442.0, 0.0624, 0.0374) + 1.056 * lobe(l, 599.8, 0.0264, 0.0323) -
                                  0.065 * lobe(l, 501.1, 0.0490, 0.0382),
                              0.821 * lobe(l, 568.8, 0.0213, 0.0247) + 0.286 * lobe(l, 530.9, 0.0613, 0.0322),
                              1.217 * lobe(l, 437.0, 0.0845, 0.0278) + 0.681 * lobe(l, 459.0, 0.0385, 0.0725));
    // IEC 61966-2-1.
    Eigen::Matrix3d rec709_from_xyz;
    rec709_from_xyz << 3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570;
    return rec709_from_xyz * xyz;
}

std::vector<SpectralSample> white_spectrum(int count) {
    assert(count >= 1);
    std::vector<SpectralSample> samples;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < count; ++i) {
        const double l = shortest_wavelength_nm + (longest_wavelength_nm - shortest_wavelength_nm) * (i + 0.5) / count;
        samples.push_back({l, spectral_color_rec709(l)});
        sum += samples.back().color_rec709;
    }
    for (SpectralSample& sample : samples) sample.color_rec709 = sample.color_rec709.cwiseQuotient(sum);
    return samples;
}

}  // namespace matchlight
