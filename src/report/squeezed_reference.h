// Pictures squeezed into squares and magnified again, in double precision.
#pragma once

#include "report/bright_reference.h"

namespace matchlight {

/// Means over the parts of an RGB `image` that each texel of a smaller or larger image covers.
ImageD squeezed(const ImageD& image, int width, int height);

/// Adds weight · (image interpolated bilinearly to the size of `sum`; beyond its outermost texels' centres they hold).
void add_magnified(const ImageD& image, double weight, ImageD& sum);

}  // namespace matchlight
