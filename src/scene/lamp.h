// Analytic lights: points, suns and spots, as a scene file or a glTF model names them.
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Core>

namespace matchlight {

enum class LampType { point, directional, spot };

/// Of a scene.
inline constexpr std::size_t most_lamps = 32;

/// Falloff, range and cones are those of glTF's KHR_lights_punctual; intensities are in the probe's own units.
struct LampSettings {
    LampType type = LampType::point;
    Eigen::Vector3d color = Eigen::Vector3d::Ones();  // scene-linear
    double intensity = 1;  // irradiance of what faces it, 1 m away; of directional lights: anywhere
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  // in which its light goes; any length but 0
    double inner_cone_deg = 0;                              // half angles: full light within
    double outer_cone_deg = 45;                             // and none beyond
    std::optional<double> range_m = {};                     // its light ends there; absent: nowhere
    double radius_m = 0;                                    // of the ball that shines; 0: hard shadows
    double angle_deg = 0;                                   // of directional lights: the disc's diameter
    bool casts_shadow = true;
    /// The lamp is real: the footage holds its light, and the probe does not. Unless given, where there is no probe.
    std::optional<bool> in_footage = {};
    bool of_probe = false;  // it stands for a bright part of the probe, for classic shading alone; no file says it

    bool operator==(const LampSettings&) const = default;
};

}  // namespace matchlight
