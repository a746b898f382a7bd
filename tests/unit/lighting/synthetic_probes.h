// Probes of known light, for the tests of src/lighting.
#pragma once

#include <functional>
#include <random>

#include <Eigen/Core>

#include "lighting/probe.h"

namespace matchlight::test {

using Sky = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

inline Probe probe_of(int height, const Sky& sky) {
    Probe probe{ImageF(2 * height, height, 3)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            const Eigen::Vector3d radiance = sky(latlong_direction(x, y, 2 * height, height));
            for (int c = 0; c < 3; ++c) probe.latlong.at(x, y, c) = static_cast<float>(radiance[c]);
        }
    }
    return probe;
}

inline Probe furnace(int height, double radiance) {
    return probe_of(height, [=](const Eigen::Vector3d&) { return Eigen::Vector3d::Constant(radiance).eval(); });
}

/// Walls of different colour with a smooth gradient.
inline Eigen::Vector3d smooth_sky(const Eigen::Vector3d& d) {
    return {1 + 0.5 * d.x() + 0.3 * d.y() * d.z(), 0.8 + 0.4 * d.z() + 0.2 * d.x() * d.y(),
            0.6 - 0.3 * d.y() + 0.3 * d.z() * d.z()};
}

inline Eigen::Vector3d random_direction(std::mt19937& generator) {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(generator), normal(generator), normal(generator)).normalized();
}

}  // namespace matchlight::test
