// Finds the bright round picture of a fisheye lens on its black frame.
#pragma once

#include <optional>

#include "core/image.h"
#include "lighting/fisheye_lens.h"

namespace matchlight {

/// The circle in `region` of a scene-linear RGB picture, to a fraction of a pixel; parts of it may lie beyond the
/// frame. nullopt where no circle stands out: a frame that is not dark, or an edge that is not round.
std::optional<PixelCircle> find_fisheye_circle(const ImageF& light, const Region& region);

}  // namespace matchlight
