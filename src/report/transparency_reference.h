// Transparent layers over each other in double precision: exact, and as the methods that do without an order have it.
#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>

namespace matchlight {

/// What one surface adds at a pixel.
struct TransparentLayer {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();  // C, scene-linear, not premultiplied
    double opacity = 0;                               // α
    double depth_m = 0;
};

/// Front to back: Σ Cᵢαᵢ·Π(1 − αⱼ) + W·Π(1 − αᵢ), W behind them all. The layers are in order, nearest first.
Eigen::Vector3d composite_in_order(std::span<const TransparentLayer> nearest_first, const Eigen::Vector3d& behind);

/// What front depth peeling has after so many layers.
struct PeeledLight {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();  // premultiplied
    double transmittance = 1;
};
PeeledLight peeled(std::span<const TransparentLayer> nearest_first, std::size_t layers);

/// Σ Cᵢαᵢ + W(1 − Σαᵢ), the first orders in α of the exact sum (Meshkin 2007, "Sort-Independent Alpha Blending"). One
/// layer is exact; what several add to more than 1 becomes negative.
Eigen::Vector3d weighted_sum(std::span<const TransparentLayer> layers, const Eigen::Vector3d& behind);

/// (Σ Cᵢαᵢwᵢ / Σ αᵢwᵢ)·(1 − Π(1 − αᵢ)) + W·Π(1 − αᵢ) (McGuire & Bavoil 2013, "Weighted Blended Order-Independent
/// Transparency", eq. 6).
Eigen::Vector3d weighted_blended(std::span<const TransparentLayer> layers, const Eigen::Vector3d& behind,
                                 const std::function<double(const TransparentLayer&)>& weight);
/// Their eq. 9, for depths of 0.1 to 500 of what the scene is measured in; multiplied by α as they advise.
double blended_weight(double depth, double opacity);

}  // namespace matchlight
