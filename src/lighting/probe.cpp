// The lat-long image of a probe: looking radiance up, turning and scaling it.
#include "lighting/probe.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "lighting/latlong_lookup.h"

namespace matchlight {
namespace {

using std::numbers::pi;

constexpr std::array<std::pair<ProbeMapping, const char*>, 4> mapping_names = {
    {{ProbeMapping::latlong, "latlong"},
     {ProbeMapping::angular, "angular"},
     {ProbeMapping::mirrorball, "mirrorball"},
     {ProbeMapping::cube, "cube"}}};

}  // namespace

std::optional<ProbeMapping> probe_mapping_from_name(const std::string& name) {
    for (const auto& [mapping, known] : mapping_names) {
        if (name == known) return mapping;
    }
    return std::nullopt;
}

std::string name_of(ProbeMapping mapping) {
    for (const auto& [known, name] : mapping_names) {
        if (mapping == known) return name;
    }
    assert(false);
    return {};
}

Eigen::Vector3d latlong_direction(double x, double y, int width, int height) {
    const double azimuth = (x + 0.5) / width * 2 * pi - pi;  // from +y towards +x
    const double polar = (y + 0.5) / height * pi;            // from +z
    return {std::sin(polar) * std::sin(azimuth), std::sin(polar) * std::cos(azimuth), std::cos(polar)};
}

Eigen::Vector2d latlong_pixel(const Eigen::Vector3d& direction, int width, int height) {
    // atan2 instead of acos keeps full precision near the poles and needs no unit length.
    const double polar = std::atan2(std::hypot(direction.x(), direction.y()), direction.z());
    const double azimuth = std::atan2(direction.x(), direction.y());
    return {(azimuth + pi) / (2 * pi) * width - 0.5, polar / pi * height - 0.5};
}

Eigen::Vector3d Probe::radiance(const Eigen::Vector3d& world_direction) const {
    assert(!latlong.empty() && latlong.channels() == 3);
    const LatlongTaps at(world_direction, latlong.width(), latlong.height());
    Eigen::Vector3d sum;
    for (int c = 0; c < 3; ++c) {
        const double upper =
            latlong.at(at.x[0], at.y[0], c) * (1 - at.across) + latlong.at(at.x[1], at.y[0], c) * at.across;
        const double lower =
            latlong.at(at.x[0], at.y[1], c) * (1 - at.across) + latlong.at(at.x[1], at.y[1], c) * at.across;
        sum[c] = upper * (1 - at.down) + lower * at.down;
    }
    return sum;
}

Probe placed(const Probe& probe, const ProbePlacement& placement) {
    return {turned_latlong(probe.latlong, placement.rotation_deg, std::exp2(placement.exposure_ev))};
}

}  // namespace matchlight
