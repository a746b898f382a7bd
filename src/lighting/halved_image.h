// An image at half its size.
#pragma once

#include "core/image.h"

namespace matchlight {

/// Every pixel the mean of four; what lies outside the image counts as 0. `width` × `height` is half the image's size,
/// rounded as the caller needs an odd last row or column left out or kept.
ImageF halved(const ImageF& image, int width, int height);

}  // namespace matchlight
