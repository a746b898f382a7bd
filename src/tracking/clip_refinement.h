// From a rig and a path found frame by frame to the ones that explain the whole clip best.
#pragma once

#include "tracking/clip_context.h"
#include "tracking/geometry_stage.h"

namespace matchlight {

/// Bundle adjustment of lens, read-out, places and poses, then a smooth path. `frames` are seen through
/// geometry.camera, and what geometry.path was solved from; covariances become marginal over all that is shared.
void refine_geometry(const ClipContext& context, const std::vector<FrameObservations>& frames,
                     GeometrySolution& geometry);

}  // namespace matchlight
