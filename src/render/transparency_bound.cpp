// Bounds from opacity alone, and from the response.
#include "render/transparency_bound.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace matchlight {

double residual_of_tolerance(double tolerance_codes) {
    assert(tolerance_codes > 0);
    return tolerance_codes / (2 * 255);
}

int layers_of_opacity(double least_opacity, double residual) {
    assert(residual > 0);
    if (residual >= 1) return 0;
    if (least_opacity >= 1) return 1;
    if (!(least_opacity > 0)) return most_peeled_layers;
    const double layers = std::log(residual) / std::log1p(-least_opacity);
    // A count that is whole but for the rounding of its logarithms is that count.
    constexpr double rounding = 1e-12;
    return static_cast<int>(std::min<double>(std::ceil(layers * (1 - rounding)), most_peeled_layers));
}

double opacity_of_layers(int layers, double residual) {
    assert(layers > 0 && residual > 0 && residual <= 1);
    return -std::expm1(std::log(residual) / layers);
}

double residual_codes(const CodeOfChannel& code_of, const Eigen::Vector3d& light, double transmittance,
                      const Eigen::Vector3d& most_light) {
    double most = 0;
    for (int channel = 0; channel < 3; ++channel) {
        const double behind = transmittance * most_light[channel];
        const double codes = 255 * (code_of(light[channel] + behind, channel) - code_of(light[channel], channel));
        if (!std::isfinite(codes)) return std::numeric_limits<double>::infinity();
        most = std::max(most, codes);
    }
    return most;
}

bool may_stop(const CodeOfChannel& code_of, const Eigen::Vector3d& light, double transmittance,
              const Eigen::Vector3d& most_light, double tolerance_codes) {
    return residual_codes(code_of, light, transmittance, most_light) <= tolerance_codes / 2;
}

double residual_of_tolerance(const CodeOfChannel& code_of, const Eigen::Vector3d& most_light, double tolerance_codes) {
    assert(tolerance_codes > 0);
    // Light gathered before: none, and over nine decades in steps of 4 %, for a response is steepest in the dark.
    const auto keeps = [&](double transmittance) {
        constexpr int steps = 512;
        constexpr double decades = 9;
        for (int step = 0; step <= steps; ++step) {
            const double share = step == 0 ? 0 : std::pow(10, decades * (static_cast<double>(step) / steps - 1));
            const Eigen::Vector3d gathered = share * (1 - transmittance) * most_light;
            if (!may_stop(code_of, gathered, transmittance, most_light, tolerance_codes)) return false;
        }
        return true;
    };
    if (keeps(1)) return 1;
    // Bisected in the exponent: light of a million is stopped at a millionth of its share.
    double kept = -60, broken = 0;  // of 10
    if (!keeps(std::pow(10, kept))) return std::pow(10, kept);
    while (broken - kept > 4e-7) {
        const double middle = (kept + broken) / 2;
        (keeps(std::pow(10, middle)) ? kept : broken) = middle;
    }
    return std::pow(10, kept);
}

}  // namespace matchlight
