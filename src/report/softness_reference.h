// The double-precision references of what lens and codec do to the virtual layer on plate pixels.
#pragma once

#include "core/image.h"
#include "report/bright_reference.h"

namespace matchlight {

/// A Gaussian over the whole of an image, at its edges as the image ends there. The weights are those at whole pixels,
/// out to 8 standard deviations, of the Gaussian whose sampled variance is sigma_px².
ImageD reference_softness(const ImageD& image, double sigma_px);

}  // namespace matchlight
