// The colours in which a FLIP error map is shown.
#pragma once

#include "core/image.h"

namespace matchlight {

/// 8-bit sRGB picture of an error map (1 channel, 0..1) in the magma colour map, as the authors' own tool shows it:
/// black is no error, pale yellow the largest.
Image8 flip_colors(const ImageF& error_map);

}  // namespace matchlight
