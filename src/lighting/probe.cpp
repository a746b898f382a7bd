// The lat-long image of a probe: looking radiance up, turning and scaling it.
#include "lighting/probe.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace matchlight {
namespace {

using std::numbers::pi;

constexpr std::array<std::pair<ProbeMapping, const char*>, 4> mapping_names = {
    {{ProbeMapping::latlong, "latlong"},
     {ProbeMapping::angular, "angular"},
     {ProbeMapping::mirrorball, "mirrorball"},
     {ProbeMapping::cube, "cube"}}};

int wrapped(int x, int width) {
    const int remainder = x % width;
    return remainder < 0 ? remainder + width : remainder;
}

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
    const int width = latlong.width();
    const int height = latlong.height();
    const Eigen::Vector2d position = latlong_pixel(world_direction, width, height);
    const double left = std::floor(position.x());
    const double top = std::floor(position.y());
    const double tx = position.x() - left;
    const double ty = position.y() - top;
    const int x0 = wrapped(static_cast<int>(left), width);
    const int x1 = wrapped(static_cast<int>(left) + 1, width);
    const int y0 = std::clamp(static_cast<int>(top), 0, height - 1);
    const int y1 = std::clamp(static_cast<int>(top) + 1, 0, height - 1);
    Eigen::Vector3d sum;
    for (int c = 0; c < 3; ++c) {
        const double upper = latlong.at(x0, y0, c) * (1 - tx) + latlong.at(x1, y0, c) * tx;
        const double lower = latlong.at(x0, y1, c) * (1 - tx) + latlong.at(x1, y1, c) * tx;
        sum[c] = upper * (1 - ty) + lower * ty;
    }
    return sum;
}

Probe placed(const Probe& probe, const ProbePlacement& placement) {
    const int width = probe.latlong.width();
    const int height = probe.latlong.height();
    const double gain = std::exp2(placement.exposure_ev);
    // Azimuth runs clockwise seen from above, so light turned counter-clockwise moves to the left: each pixel takes
    // what lay to its right. Interpolation between columns keeps the sum of every row, so energy is exact.
    double shift = std::fmod(placement.rotation_deg / 360.0, 1.0) * width;
    if (shift < 0) shift += width;
    const int whole = static_cast<int>(std::floor(shift));
    const double part = shift - whole;
    Probe result{ImageF(width, height, 3)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float* near = probe.latlong.pixel(wrapped(x + whole, width), y);
            const float* far = probe.latlong.pixel(wrapped(x + whole + 1, width), y);
            float* out = result.latlong.pixel(x, y);
            for (int c = 0; c < 3; ++c) {
                const double radiance = near[c] * (1 - part) + far[c] * part;
                // A large exposure must not make infinities of finite light.
                out[c] = static_cast<float>(
                    std::min(radiance * gain, static_cast<double>(std::numeric_limits<float>::max())));
            }
        }
    }
    return result;
}

}  // namespace matchlight
