// Scene-linear light as a display shows it, without a camera.
#pragma once

#include "core/image.h"

namespace matchlight {

/// sRGB codes of RGB.
Image8 srgb_picture(const ImageF& light);

}  // namespace matchlight
