// Discs of the same solid angle.
#include "compositor/probe_lamps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/transfer.h"
#include "lighting/dominant_lights.h"

namespace matchlight {

namespace {

constexpr double pi = std::numbers::pi;

double luminance(const Eigen::Vector3d& light) {
    return luminance_rec709(light.x(), light.y(), light.z());
}

}  // namespace

std::vector<LampSettings> lamps_of_probe(const Probe& probe) {
    std::vector<LampSettings> lamps;
    const auto add = [&](const Eigen::Vector3d& to_lamp, const Eigen::Vector3d& irradiance, double angle_deg) {
        lamps.push_back({.type = LampType::directional,
                         .color = irradiance,
                         .direction = -to_lamp,
                         .angle_deg = angle_deg,
                         .in_footage = true,
                         .of_probe = true});
    };
    for (const DominantLight& light : dominant_lights(probe)) {
        const double cosine = std::clamp(1 - light.solid_angle_sr / (2 * pi), 0.0, 1.0);
        constexpr double widest_deg = 90;  // as a scene may have it
        add(light.direction.normalized(), light.power, std::min(2 * std::acos(cosine) * 180 / pi, widest_deg));
    }
    if (!lamps.empty()) return lamps;
    Eigen::Vector3d slope;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
        slope[axis] = luminance(irradiance(probe, unit)) - luminance(irradiance(probe, -unit));
    }
    if (slope.norm() < 1e-12) return lamps;
    const Eigen::Vector3d brightest = slope.normalized();
    const Eigen::Vector3d more = (irradiance(probe, brightest) - irradiance(probe, -brightest)).cwiseMax(0);
    if (more.maxCoeff() > 0) add(brightest, more, 90);
    return lamps;
}

}  // namespace matchlight
