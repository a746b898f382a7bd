// A lat-long image at a smaller size, and at half, a quarter, … of it, each with all of its light.
#pragma once

#include <vector>

#include "core/image.h"

namespace matchlight {

/// Level 0 is the image; each further one is half as wide and high (rounded down, at least 1) down to 1 × 1. A pixel is
/// the mean over the solid angle it covers, so that ∫ L dω is the same at every level.
std::vector<ImageF> latlong_pyramid(const ImageF& latlong);

/// The image at a size no larger than its own: a pixel is the mean over the solid angle it covers.
ImageF shrunk_latlong(const ImageF& latlong, int width, int height);

}  // namespace matchlight
