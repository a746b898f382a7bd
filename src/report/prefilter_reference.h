// The double-precision reference of what surfaces reflect of a probe.
#pragma once

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/probe.h"

namespace matchlight {

/// Radiance under the GGX lobe of a roughness about a direction (normal, view and reflection equal: Karis 2013, "Real
/// Shading in Unreal Engine 4"), weighted by the cosine: a sum over every pixel of the probe with its solid angle. A
/// lat-long picture of `width` × `width`/2 pixels.
ImageF reference_glossy_latlong(const Probe& probe, double roughness, int width);

/// What a mirror shows, averaged over rays × rays directions a pixel.
ImageF reference_mirror_latlong(const Probe& probe, int rays, int width);

}  // namespace matchlight
