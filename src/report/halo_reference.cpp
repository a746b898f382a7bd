// Every pixel of the kernel by the formula, convolved by FFTW.
#include "report/halo_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "render/effects/spectral_color.h"
#include "report/fftw_convolution.h"

namespace matchlight {

Image<double> reference_halo(const Image<double>& bright_light, const HaloReferenceOptions& options) {
    // f3(θ, λ) = 436.9 (568 / λ) exp(−(θ − 3 λ / 568)²), θ in degrees; the factor drops out by scaling to unit energy.
    constexpr double cut_deg = 3;
    const double widest_deg = 3 * longest_wavelength_nm / 568 + cut_deg;
    const int radius = static_cast<int>(std::ceil(options.focal_px * std::tan(widest_deg * std::numbers::pi / 180)));
    Image<double> kernel(2 * radius + 1, 2 * radius + 1, 3);
    parallel_for(kernel.height(), [&](int y) {
        for (int x = 0; x < kernel.width(); ++x) {
            std::array<double, 3> sum{};
            for (int point = 0; point < options.points * options.points; ++point) {
                const int column = point % options.points, row = point / options.points;
                const double right = x - radius + (column + 0.5) / options.points - 0.5;
                const double down = y - radius + (row + 0.5) / options.points - 0.5;
                const double theta_deg = std::atan2(std::hypot(right, down), options.focal_px) * 180 / std::numbers::pi;
                for (int i = 0; i < options.wavelengths; ++i) {
                    const double lambda_nm =
                        std::lerp(shortest_wavelength_nm, longest_wavelength_nm, (i + 0.5) / options.wavelengths);
                    const double from_ring = theta_deg - 3 * lambda_nm / 568;
                    if (std::abs(from_ring) > cut_deg) continue;
                    const double f3 = 568 / lambda_nm * std::exp(-from_ring * from_ring);
                    const Eigen::Vector3d color = spectral_color_rec709(lambda_nm);
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += f3 * color[static_cast<int>(c)];
                }
            }
            for (int c = 0; c < 3; ++c) kernel.at(x, y, c) = sum[static_cast<std::size_t>(c)];
        }
    });
    // The spectrum is white; then colours that Rec.709 does not hold are cut, and the energy is 1.
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                kernel.at(x, y, c) = std::max(kernel.at(x, y, c), 0.0);
                total[c] += kernel.at(x, y, c);
            }
        }
    }
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            for (int c = 0; c < 3; ++c) kernel.at(x, y, c) *= options.strength / total[c];
        }
    }
    return convolve_fftw(bright_light, kernel);
}

}  // namespace matchlight
