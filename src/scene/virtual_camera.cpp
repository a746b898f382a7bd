// Orbits and curves through keys.
#include "scene/virtual_camera.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace matchlight {
namespace {

CameraView on_orbit(const OrbitSettings& orbit, double share) {
    constexpr double radians = std::numbers::pi / 180;
    const double azimuth = (orbit.from_deg + (orbit.to_deg - orbit.from_deg) * share) * radians;
    const double elevation = orbit.elevation_deg * radians;
    const Eigen::Vector3d outward(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                  std::sin(elevation));
    return {orbit.target_m + orbit.radius_m * outward, orbit.target_m};
}

using Place = Eigen::Matrix<double, 6, 1>;  // eye, target

Place place_of(const CameraKey& key) {
    return (Place() << key.eye_m, key.target_m).finished();
}

/// The slope of the parabola through a key and its neighbours; of the line to the only neighbour at either end.
Place tangent_at(const std::vector<CameraKey>& keys, std::size_t i) {
    const auto slope = [&](std::size_t from) -> Place {
        const auto step = static_cast<double>(keys[from + 1].frame - keys[from].frame);
        return (place_of(keys[from + 1]) - place_of(keys[from])) / step;
    };
    if (i == 0) return slope(0);
    if (i + 1 == keys.size()) return slope(i - 1);
    const auto before = static_cast<double>(keys[i].frame - keys[i - 1].frame);
    const auto after = static_cast<double>(keys[i + 1].frame - keys[i].frame);
    return (after * slope(i - 1) + before * slope(i)) / (before + after);
}

Place between_keys(const std::vector<CameraKey>& keys, double frame) {
    if (frame <= static_cast<double>(keys.front().frame)) return place_of(keys.front());
    if (frame >= static_cast<double>(keys.back().frame)) return place_of(keys.back());
    const auto above = std::upper_bound(keys.begin(), keys.end(), frame, [](double value, const CameraKey& key) {
        return value < static_cast<double>(key.frame);
    });
    const auto i = static_cast<std::size_t>(above - keys.begin()) - 1;
    const auto step = static_cast<double>(keys[i + 1].frame - keys[i].frame);
    const double t = (frame - static_cast<double>(keys[i].frame)) / step;
    const double t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * place_of(keys[i]) + (t3 - 2 * t2 + t) * step * tangent_at(keys, i) +
           (3 * t2 - 2 * t3) * place_of(keys[i + 1]) + (t3 - t2) * step * tangent_at(keys, i + 1);
}

}  // namespace

CameraView camera_view(const CameraSettings& camera, double frame) {
    if (camera.orbit) {
        const auto last = static_cast<double>(std::max<std::int64_t>(1, camera.frames - 1));
        return on_orbit(*camera.orbit, frame / last);
    }
    assert(!camera.keys.empty());
    const Place place = between_keys(camera.keys, frame);
    return {place.head<3>(), place.tail<3>()};
}

}  // namespace matchlight
