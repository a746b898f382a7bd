// The power spectrum of the aperture, gathered over wavelengths into the texels of a kernel.
#include "render/effects/diffraction.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <complex>
#include <mutex>
#include <numbers>
#include <vector>

#include <fftw3.h>

#include "core/parallel.h"
#include "render/effects/aperture.h"
#include "render/effects/kernel.h"
#include "render/effects/spectral_color.h"

namespace matchlight {
namespace {

using Complex = std::complex<double>;

/// Samples of a power spectrum from an aperture image λ / (4 · diameter) apart: as many to the first dark ring.
constexpr double ring_in_samples = airy_ring * aperture_field;

/// The transform of a real picture: columns 0 … side / 2.
std::vector<Complex> transformed(const Image<double>& image) {
    const int side = image.width();
    std::vector<double> in(image.samples().begin(), image.samples().end());
    std::vector<Complex> out(static_cast<std::size_t>(side / 2 + 1) * side);
    static std::mutex planner;  // FFTW's is not safe for threads
    const std::lock_guard lock(planner);
    const fftw_plan plan =
        fftw_plan_dft_r2c_2d(side, side, in.data(), reinterpret_cast<fftw_complex*>(out.data()), FFTW_ESTIMATE);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    return out;
}

/// |FFT(aperture)|², no more in its middle than beyond the first dark ring.
class PowerSpectrum {
public:
    PowerSpectrum(const ApertureSettings& aperture, int side, double furthest_sample)
        : reach_(std::min(side / 2 - 1, static_cast<int>(std::ceil(furthest_sample)) + 2)),
          amplitude_(2 * reach_ + 1, 2 * reach_ + 1, 2) {
        const auto spectrum = transformed(make_aperture_image(aperture, side));
        // A texel holds the mean over its square, which weakens high frequencies by a known factor; and the aperture is
        // in the image's middle instead of its corner, without which the phase would turn fast from sample to sample.
        std::vector<Complex> restored;
        for (int k = -reach_; k <= reach_; ++k) {
            const double x = std::numbers::pi * k / side;
            restored.push_back(std::polar(k == 0 ? 1 : x / std::sin(x), x * (side - 1)));
        }
        for (int y = -reach_; y <= reach_; ++y) {
            for (int x = -reach_; x <= reach_; ++x) {
                // The left half mirrors the right one.
                const int row = ((x < 0 ? -y : y) + side) % side;
                const Complex half = spectrum[static_cast<std::size_t>(row) * (side / 2 + 1) + std::abs(x)];
                const Complex amplitude = (x < 0 ? std::conj(half) : half) *
                                          restored[static_cast<std::size_t>(x + reach_)] *
                                          restored[static_cast<std::size_t>(y + reach_)];
                amplitude_.at(x + reach_, y + reach_, 0) = amplitude.real();
                amplitude_.at(x + reach_, y + reach_, 1) = amplitude.imag();
                if (std::hypot(x, y) >= ring_in_samples) most_ = std::max(most_, std::norm(amplitude));
            }
        }
    }

    /// The amplitude between samples is by Catmull-Rom splines; it is 0 beyond what was computed.
    double at(double x, double y) const {
        const double left = std::floor(x);
        const double top = std::floor(y);
        const int column = static_cast<int>(left) + reach_ - 1;
        const int row = static_cast<int>(top) + reach_ - 1;
        if (column < 0 || row < 0 || column + 4 > amplitude_.width() || row + 4 > amplitude_.height()) return 0;
        const auto across = weights(x - left);
        const auto down = weights(y - top);
        double re = 0, im = 0;
        for (int v = 0; v < 4; ++v) {
            const double* p = amplitude_.pixel(column, row + v);
            const double weight = down[static_cast<std::size_t>(v)];
            re += weight * (across[0] * p[0] + across[1] * p[2] + across[2] * p[4] + across[3] * p[6]);
            im += weight * (across[0] * p[1] + across[1] * p[3] + across[2] * p[5] + across[3] * p[7]);
        }
        return std::min(re * re + im * im, most_);
    }

private:
    static std::array<double, 4> weights(double t) {
        return {0.5 * t * (-1 + t * (2 - t)), 0.5 * (2 + t * t * (3 * t - 5)), 0.5 * t * (1 + t * (4 - 3 * t)),
                0.5 * t * t * (t - 1)};
    }

    int reach_;
    Image<double> amplitude_;  // real and imaginary part; the pattern's middle in the middle
    double most_ = 0;          // power beyond the first dark ring
};

/// 1 up to three quarters of the reach, 0 from the reach on.
double fade(double share_of_reach) {
    const double t = std::clamp(4 * share_of_reach - 3, 0.0, 1.0);
    return 0.5 + 0.5 * std::cos(std::numbers::pi * t);
}

}  // namespace

double airy_radius_px(double f_number, double pixel_pitch_um) {
    return airy_ring * diffraction_wavelength_nm * 1e-3 * f_number / pixel_pitch_um;
}

double diffraction_reach_px(const GlareSettings& settings, int frame_height) {
    const ApertureSettings& aperture = settings.aperture;
    if (aperture.f_number && aperture.pixel_pitch_um) {
        return reach_in_airy_radii * airy_radius_px(*aperture.f_number, *aperture.pixel_pitch_um);
    }
    return settings.size * frame_height;
}

Image<double> make_diffraction_kernel(const ApertureSettings& aperture, double reach_px, const KernelGrid& grid,
                                      const DiffractionQuality& quality) {
    assert(reach_px > 0 && grid.scale >= 1 && quality.wavelengths >= 4 && quality.samples > 0);
    const double sample_px = reach_px / (reach_in_airy_radii * ring_in_samples);  // at the wavelength of sizes
    const double furthest_sample = reach_px / sample_px * diffraction_wavelength_nm / shortest_wavelength_nm;
    const PowerSpectrum power(aperture, quality.aperture_side, furthest_sample);
    const std::vector<SpectralSample> spectrum = white_spectrum(quality.wavelengths);

    const auto light_at = [&](const Eigen::Vector2d& offset_px) -> Eigen::Vector3d {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        const double weight = fade(offset_px.norm() / reach_px);
        if (weight == 0) return sum;
        for (const SpectralSample& sample : spectrum) {
            // Twice the wavelength makes the pattern twice as wide and a quarter as bright.
            const double narrowed = diffraction_wavelength_nm / sample.wavelength_nm;
            const Eigen::Vector2d place = offset_px * (narrowed / sample_px);
            sum += sample.color_rec709 * (power.at(place.x(), place.y()) * narrowed * narrowed);
        }
        return sum * weight;
    };
    return gather_kernel({.reach_px = reach_px, .detail_px = sample_px / quality.samples}, grid, light_at);
}

}  // namespace matchlight
