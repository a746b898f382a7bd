// Panoramas of all directions as probes: turned, resized, and honest of their holes.
#pragma once

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/stitched_sphere.h"

namespace matchlight {

/// A 2:1 equirectangular picture in scene-linear light, whose middle looks along +y of its own axes, laid onto a map of
/// `height` rows. Pixels that hold no light in any channel are holes; `clipped` (1 channel, empty where nothing is
/// known) tells which are lower bounds. Without a turn nothing is blurred.
StitchedSphere panorama_sphere(const ImageF& light, const ImageF& clipped, const Eigen::Matrix3d& world_from_picture,
                               int height);

/// Whether a picture has the shape of all directions: twice as wide as high, to a pixel or two.
bool is_panorama_shape(int width, int height);

}  // namespace matchlight
