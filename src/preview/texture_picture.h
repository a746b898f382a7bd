// A texture that a pass left, as a picture to be looked at.
#pragma once

#include <string>

#include "core/image.h"
#include "render/graph.h"

namespace matchlight {

/// As large as the frame. What is a part of the frame is where it belongs, black around it; another texture (a map of
/// the light, say) is fitted in. Texels are shown as they are, the largest finite value as white, through the sRGB
/// curve; depths from the nearest (white) to the farthest. NaN and infinity are magenta.
Image8 picture_of_texture(const WatchedTexture& texture, int width, int height);
/// "bloom/down 2: 160×90 texels of 4 pixels, 0 to 12.3".
std::string words_of_texture(const WatchedTexture& texture);

}  // namespace matchlight
