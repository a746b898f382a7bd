// Rings of all wavelengths, gathered into the texels of a kernel.
#include "render/effects/halo.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/effects/kernel.h"
#include "render/effects/spectral_color.h"

namespace matchlight {
namespace {

constexpr double degree = std::numbers::pi / 180;
/// The ring's middle, for 568 nm.
constexpr double ring_deg = 3;
constexpr double ring_wavelength_nm = 568;
constexpr double ring_cut_deg = 3;
constexpr double ring_deviation_deg = 0.70710678;  // exp(−x²)

double ring_middle_deg(double wavelength_nm) {
    return ring_deg * wavelength_nm / ring_wavelength_nm;
}

}  // namespace

double halo_reach_px(double focal_px) {
    return focal_px * std::tan((ring_middle_deg(longest_wavelength_nm) + ring_cut_deg) * degree);
}

Image<double> make_halo_kernel(double focal_px, const KernelGrid& grid, const HaloQuality& quality) {
    assert(focal_px > 0 && grid.scale >= 1 && quality.wavelengths >= 4 && quality.samples > 0);
    const std::vector<SpectralSample> spectrum = white_spectrum(quality.wavelengths);
    const auto light_at = [&](const Eigen::Vector2d& offset_px) -> Eigen::Vector3d {
        const double angle_deg = std::atan(offset_px.norm() / focal_px) / degree;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const SpectralSample& sample : spectrum) {
            const double from_ring = angle_deg - ring_middle_deg(sample.wavelength_nm);
            if (std::abs(from_ring) > ring_cut_deg) continue;
            // The paper's height of the ring, 568 / λ.
            sum += sample.color_rec709 * (ring_wavelength_nm / sample.wavelength_nm * std::exp(-from_ring * from_ring));
        }
        return sum;
    };
    return gather_kernel({.reach_px = halo_reach_px(focal_px),
                          .detail_px = focal_px * std::tan(ring_deviation_deg * degree) / quality.samples},
                         grid, light_at);
}

}  // namespace matchlight
