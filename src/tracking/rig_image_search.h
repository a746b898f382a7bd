// Where in the picture a moving rig of tags may be: rough, but from far off.
#pragma once

#include <vector>

#include "tracking/rig_image_model.h"
#include "tracking/tag_pixels.h"

namespace matchlight {

/// A place that explains the picture better than those around it.
struct RigPlace {
    MovingCamera camera;
    double unexplained = 1;  // share of the light's variance over the tags
};

/// Turns the camera of `start` so that the rig moves by up to `reach_px` in the picture, for several lengths of its
/// motion, and compares blurred light with the blurred pattern. The best few places, best first, at least
/// 8 px apart.
std::vector<RigPlace> search_rig(const FitSource& source, const std::vector<PlacedSheet>& sheets,
                                 const MovingCamera& start, double reach_px);

}  // namespace matchlight
