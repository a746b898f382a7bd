// The double-precision reference of analytic lights: the cone in which a lamp is seen, ray by ray.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "scene/lamp.h"

namespace matchlight {

/// Whether something stands between two points, which may be far away.
using Blocked = std::function<bool(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m)>;

/// Irradiance of a point with a normal by a lamp: of balls and discs ∫ V L max(0, n·ω) dω over `rays` directions of
/// equal solid angle, of points V E max(0, n·ω). Falloff, window and cone as glTF's KHR_lights_punctual has them; a
/// point within the ball, or a millimetre of a point, has what is there.
Eigen::Vector3d reference_lamp_irradiance(const LampSettings& lamp, const Eigen::Vector3d& point_m,
                                          const Eigen::Vector3d& normal, const Blocked& blocked, int rays);

}  // namespace matchlight
