// The double-precision reference of the bright pass, pixel by pixel.
#pragma once

#include "core/image.h"
#include "render/effects/bright_light.h"

namespace matchlight {

using ImageD = Image<double>;

/// What the bright pass should find at one pixel each: RGB of the size of `after` (RGBA: light, and the share of it
/// that objects send). `before` (RGB or RGBA) may be empty. Weights against fireflies included where `settings` ask for
/// them.
ImageD reference_bright_light(const ImageF& after, const ImageF& before, const BrightPassSettings& settings);

/// The sum over all pixels of each channel's magnitude that weights against fireflies hold back.
double energy_held_back(const ImageF& after, const ImageF& before, BrightPassSettings settings);

}  // namespace matchlight
