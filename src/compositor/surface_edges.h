// Where the picture of the real surface ends: small holes are closed, and knowledge falls softly to nothing.
#pragma once

#include "render/gathered_surface.h"

namespace matchlight {

/// Texels that are hardly known, among neighbours most of which are, take the neighbours' mean.
void close_holes(GatheredSurface& gathered);

/// Knowledge falls to 0 over 16 texels before what is unknown and before the rectangle's border, so that the change to
/// another source of light is no step.
void soften_edges(GatheredSurface& gathered);

/// As files and textures keep it: the same bits, whether gathered or read.
void round_to_half(ImageF& image);

}  // namespace matchlight
