// The double-precision reference of exposure control: metering pixel by pixel, adaptation in closed form, tone curve.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/image.h"

namespace matchlight {

struct ReferenceMeter {
    std::optional<double> log2_average;
    std::optional<double> log2_maximum;
};

/// Over the pixels of `light` (RGB or RGBA, linear) whose luminance is finite and above `black`: the mean of log₂ L
/// without the darkest and the brightest share of them, and the maximum. Reinhard et al. 2002, equation 1, without its
/// δ, which black pixels need there.
ReferenceMeter reference_meter(const ImageF& light, double black, double darkest_share, double brightest_share);

/// Where adaptation from `start` towards a target that holds still is after a time: T + (E − T) exp(−t/τ).
double reference_adaptation(double start, double target, double elapsed_s, double time_constant_s);

/// Equation 4: L (1 + L/Lw²) / (1 + L) on luminance, colour kept.
Eigen::Vector3d reference_tone(const Eigen::Vector3d& linear, double white);

}  // namespace matchlight
