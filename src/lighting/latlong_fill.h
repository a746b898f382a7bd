// Lat-long maps with pixels that nobody saw, filled from around them.
#pragma once

#include "core/image.h"

namespace matchlight {

/// Fills pixels of `radiance` (RGB) whose weight in `known` (1 channel, same size) is 0 from those around them: means
/// over ever larger pixels, then back (pull-push; Gortler et al. 1996, "The Lumigraph", §3.4), over the lat-long map
/// with its seam closed.
void fill_unseen(ImageF& radiance, const ImageF& known);

}  // namespace matchlight
