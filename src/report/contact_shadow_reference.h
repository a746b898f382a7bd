// The double-precision reference of the contact shadow: every pixel of the probe is a light, every light a ray.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "lighting/probe.h"

namespace matchlight {

/// Whether the ray from a world point along a unit direction meets a caster.
using Occlusion = std::function<bool(const Eigen::Vector3d& point_world_m, const Eigen::Vector3d& direction)>;

/// Light with the casters over light without, per channel, at a point of a surface whose normal is +z:
/// ∫ V L max(0, z) dω / ∫ L max(0, z) dω over the probe's pixels, each with its exact solid angle. Channels without
/// light give 1.
Eigen::Vector3d reference_contact_shadow(const Probe& probe, const Eigen::Vector3d& point_world_m,
                                         const Occlusion& occluded);

}  // namespace matchlight
