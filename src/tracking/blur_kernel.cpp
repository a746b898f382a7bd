// The normal equation of the fitted variance, by quadrature and Newton's method.
#include "tracking/blur_kernel.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

namespace {

double sinc(double x) {
    return std::abs(x) < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x;
}

/// Transfer of a disc at x = ω · diameter / 2, and −J₂(x), for its derivative.
struct DiscTransfer {
    double value = 1, minus_j2 = 0;
};

DiscTransfer disc_transfer(double x) {
    if (x < 0.05) return {1 - x * x / 8, -x * x / 8 * (1 - x * x / 12)};
    const double j1_by_x = ::j1(x) / x;
    return {2 * j1_by_x, ::j0(x) - 2 * j1_by_x};
}

/// ∂ sinc(ωL/2) / ∂(L²/12) at x = ωL/2.
double box_transfer_by_variance(double x, double omega) {
    if (x < 0.05) return -omega * omega / 2 * (1 - x * x / 10);
    // dx/dM = x / 2M, M = L²/12 = x²/(3ω²)
    return (std::cos(x) - std::sin(x) / x) * 1.5 * omega * omega / (x * x);
}

/// Integrals of the normal equation and of its derivatives.
struct Equation {
    double value = 0, by_fitted = 0, by_disc = 0, by_motion = 0, by_gaussian = 0;
};

Equation equation_at(double fitted, const EdgeKernel& kernel) {
    const double diameter = 4 * std::sqrt(kernel.disc), length = std::sqrt(12 * kernel.motion);
    // The integrands fall off with exp(−v ω²/2); the midpoint rule is exact to rounding for such.
    constexpr int nodes = 40;
    constexpr double last_sigma = 5.5, last_omega = 60;
    const double step = std::min(last_sigma / std::sqrt(fitted), last_omega) / nodes;
    Equation sum;
    for (int i = 0; i < nodes; ++i) {
        const double omega = (i + 0.5) * step, omega2 = omega * omega;
        const double model_pixel = sinc(omega / 2);
        const double pixel = sinc(omega * kernel.normal.x() / 2) * sinc(omega * kernel.normal.y() / 2);
        const DiscTransfer disc = disc_transfer(omega * diameter / 2);
        const double box_x = omega * length / 2;
        const double box = sinc(box_x), gaussian = std::exp(-kernel.gaussian * omega2 / 2);
        const double model = model_pixel * std::exp(-fitted * omega2 / 2);
        const double seen = pixel * disc.value * box * gaussian;
        sum.value += (seen - model) * model;
        sum.by_fitted += -omega2 / 2 * (seen - 2 * model) * model;
        const double disc_by_variance = kernel.disc > 1e-6 ? disc.minus_j2 / kernel.disc : -omega2 / 2;
        sum.by_disc += pixel * disc_by_variance * box * gaussian * model;
        sum.by_motion += pixel * disc.value * box_transfer_by_variance(box_x, omega) * gaussian * model;
        sum.by_gaussian += -omega2 / 2 * seen * model;
    }
    return sum;
}

}  // namespace

FittedVariance fitted_variance(const EdgeKernel& kernel) {
    constexpr double least_gaussian = 0.01;  // px²: a tenth of the pixel's own
    EdgeKernel bounded = kernel;
    bounded.disc = std::max(0.0, kernel.disc);
    bounded.motion = std::max(0.0, kernel.motion);
    bounded.gaussian = std::max(least_gaussian, kernel.gaussian);
    constexpr double least = 0.1 * least_gaussian;
    double fitted = bounded.disc + bounded.motion + bounded.gaussian;
    Equation at;
    constexpr int most_steps = 12;
    for (int i = 0; i < most_steps; ++i) {
        at = equation_at(fitted, bounded);
        const double change = -at.value / at.by_fitted;
        fitted = std::clamp(fitted + change, std::max(least, 0.5 * fitted), 2 * fitted);
        if (std::abs(change) < 1e-5 * fitted) break;
    }
    FittedVariance result;
    result.by_disc = -at.by_disc / at.by_fitted;
    result.by_motion = -at.by_motion / at.by_fitted;
    result.by_gaussian = -at.by_gaussian / at.by_fitted;
    result.value = fitted + (kernel.disc - bounded.disc) * result.by_disc +
                   (kernel.motion - bounded.motion) * result.by_motion +
                   (kernel.gaussian - bounded.gaussian) * result.by_gaussian;
    return result;
}

}  // namespace matchlight
