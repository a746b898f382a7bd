// What grain is, without GL: its model, and random numbers that are a pure function of seed, frame and pixel.
//
// Variance = read² + shot · signal, plate-linear (the sensor's read noise and the Poisson noise of light: Janesick
// 2007, "Photon Transfer"; Foi et al. 2008, "Practical Poissonian-Gaussian noise modeling and fitting for single-image
// raw-data"). Of the plate's own noise a share `kept` (shadow ratio · (1 − coverage)) is left in a pixel; what is added
// has the variance that is missing: read² + shot · L − kept² (read² + shot · P), L the pixel's light, P the plate's.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace matchlight {

/// Four words from four: pcg4d (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering", JCGT 9(3)).
std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v);

/// So many bits of a word choose one of as many equally probable values of a normal distribution.
inline constexpr int grain_quantile_bits = 12;

/// The middles of 2^grain_quantile_bits equally probable parts of the standard normal distribution, scaled to a
/// variance of exactly 1; the largest is 3.67. A table, as logarithm and cosine differ from GPU to GPU.
std::vector<float> grain_quantiles();

/// Weights from the middle to one side (the other is its mirror) whose squares sum to 1 over both: white noise smoothed
/// with them across and down keeps its variance. A Gaussian of this standard deviation; a single 1 where that is under
/// least_grain_correlation_px.
std::vector<float> grain_taps(double correlation_px);

/// Smoothing by less correlates neighbours by less than 1e-5.
inline constexpr double least_grain_correlation_px = 0.2;
/// The widest there is: neighbours correlate by 0.98.
inline constexpr double widest_grain_correlation_px = 4;

/// Correlation of neighbours in noise smoothed with grain_taps().
double grain_neighbour_correlation(double correlation_px);
/// Its inverse. 0 where neighbours do not correlate, or correlate negatively, as after sharpening.
double grain_correlation_px(double neighbour_correlation);

struct GrainModel {
    double read = 0, shot = 0;
    double correlation_px = 0;  // standard deviation of the Gaussian that smooths the noise; 0: white
    double strength = 1;        // times the standard deviation of what is added
    double brightest = 1;       // plate-linear: brighter light saturates the sensor, and has no more noise than this
    std::uint32_t seed = 1;
    std::uint32_t frame = 0;

    /// The largest standard deviation that anything added can have.
    double largest_deviation() const;
};

/// The least standard deviation with which a noise that has `model`'s correlation can change light by `light`.
double least_grain_deviation(const GrainModel& model, double light);

}  // namespace matchlight
