// Orbits and curves through keys.
#include "scene/virtual_camera.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "scene/key_curve.h"

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

}  // namespace

CameraView camera_view(const CameraSettings& camera, double frame) {
    if (camera.orbit) {
        const auto last = static_cast<double>(std::max<std::int64_t>(1, camera.frames - 1));
        return on_orbit(*camera.orbit, frame / last);
    }
    assert(!camera.keys.empty());
    const Place place = between_keys(camera.keys, frame, place_of);
    return {place.head<3>(), place.tail<3>()};
}

}  // namespace matchlight
