// Pictures as they stand inside an HTML page.
#pragma once

#include <string>

#include "core/image.h"

namespace matchlight {

/// A PNG of the picture (1 or 3 channels) as a data URL, scaled down by area where it is wider than `most_width_px`.
std::string embedded_png(const Image8& picture, int most_width_px);

}  // namespace matchlight
