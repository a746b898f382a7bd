// The levels of a map of normals, which say how far the normals within a texel differ.
#pragma once

#include <vector>

#include "core/image.h"

namespace matchlight {

/// From the finest to one texel, each half as large. RGB are codes of the mean normal. Alpha, which glTF leaves free,
/// is the deviation of x and y together, √(Σ variances), 0 to 1: 0 in the finest level, so that nothing is widened that
/// the picture resolves. After Toksvig 2005, "Mipmapping Normal Maps", and Olano & Baker 2010, "LEAN Mapping", whose
/// second moments are taken here before codes round them.
std::vector<Image8> normal_levels(const Image8& rgba);

}  // namespace matchlight
