// The opening of the lens as a picture: blades, and what lies before them.
#pragma once

#include "core/image.h"
#include "scene/effects.h"

namespace matchlight {

/// How far the blades' edge is from the middle, in radii of the circle around it, at an angle counter-clockwise from
/// the picture's right. A blade's edge faces the angle `rotation_deg`, and one each 360°/blades on.
double aperture_edge(const ApertureSettings& settings, double angle_rad);

/// The side of an aperture image in diameters of the circle around its opening: dark around it, so that the samples of
/// its power spectrum lie closer than that spectrum can change.
inline constexpr int aperture_field = 4;

/// The share of the light's amplitude that each texel lets through, 0 to 1, each averaged over its square; `side` ×
/// `side`, a power of two from 16. The same settings give the same picture on every machine. Throws InputError where
/// `image` cannot be read or lets no light through.
Image<double> make_aperture_image(const ApertureSettings& settings, int side);

}  // namespace matchlight
