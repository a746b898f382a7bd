// Focus, aperture, shutter and softness of a clip, from the blur of its tags' edges.
#pragma once

#include "tracking/clip_context.h"
#include "tracking/clip_observations.h"
#include "tracking/geometry_stage.h"

namespace matchlight {

/// Fills the optics of `solve`, whose frames are those of the clip. What the footage does not tell stays absent, and
/// the summary says why.
void solve_optics_stage(const ClipContext& context, const ClipObservations& clip, const GeometrySolution& geometry,
                        Solve& solve, TrackSummary& summary);

}  // namespace matchlight
