// Views of a mirror ball that share no tags, turned onto each other by the light that both reflect.
#pragma once

#include <vector>

#include "core/warnings.h"
#include "lighting/ball_view.h"

namespace matchlight {

/// Sets camera_from_world of every view, the ball in the world's origin: of the first so that +y is where it looks and
/// +z its up, of the others so that their unwrapped pictures agree best with the first's over the directions that both
/// show. Every turn is tried, a few degrees apart, the best are refined. Throws InputError where no turn stands out.
void register_views(std::vector<BallView>& views, double ball_radius_m, Warnings& warnings);

}  // namespace matchlight
