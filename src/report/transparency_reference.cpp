// Sums over the layers of a pixel.
#include "report/transparency_reference.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

PeeledLight peeled(std::span<const TransparentLayer> nearest_first, std::size_t layers) {
    PeeledLight sum;
    for (const TransparentLayer& layer : nearest_first.first(std::min(layers, nearest_first.size()))) {
        sum.light += sum.transmittance * layer.opacity * layer.light;
        sum.transmittance *= 1 - layer.opacity;
    }
    return sum;
}

Eigen::Vector3d composite_in_order(std::span<const TransparentLayer> nearest_first, const Eigen::Vector3d& behind) {
    const PeeledLight all = peeled(nearest_first, nearest_first.size());
    return all.light + all.transmittance * behind;
}

Eigen::Vector3d weighted_sum(std::span<const TransparentLayer> layers, const Eigen::Vector3d& behind) {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    double opacity = 0;
    for (const TransparentLayer& layer : layers) {
        light += layer.opacity * layer.light;
        opacity += layer.opacity;
    }
    return light + (1 - opacity) * behind;
}

Eigen::Vector3d weighted_blended(std::span<const TransparentLayer> layers, const Eigen::Vector3d& behind,
                                 const std::function<double(const TransparentLayer&)>& weight) {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    double weights = 0, transmittance = 1;
    for (const TransparentLayer& layer : layers) {
        const double share = layer.opacity * weight(layer);
        light += share * layer.light;
        weights += share;
        transmittance *= 1 - layer.opacity;
    }
    if (weights > 0) light *= (1 - transmittance) / weights;
    return light + transmittance * behind;
}

double blended_weight(double depth, double opacity) {
    return opacity * std::clamp(0.03 / (1e-5 + std::pow(std::abs(depth) / 200, 4)), 1e-2, 3e3);
}

}  // namespace matchlight
