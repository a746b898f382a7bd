// Tags that the first look missed, found again where the solved path says they must be.
#pragma once

#include <cstdint>

#include "media/frame_source.h"
#include "tracking/clip_context.h"
#include "tracking/clip_observations.h"
#include "tracking/geometry_stage.h"

namespace matchlight {

/// Decodes again the frames in which a placed tag should be seen and was not, was fitted poorly, or was smeared by
/// motion. A tag behind a hand is fitted from its predicted corners. Where the camera moves far during the exposure, or
/// nothing was found, the whole rig is fitted to the picture at once; its tags are marked `joint`, their corners are
/// those at mid-exposure, and share one pose: each carries the covariance of that pose times the number of tags, so
/// that together they weigh what the pose does. Frames beyond the reach of the path are followed from the last pose
/// that was found. Returns how many sightings were added or replaced; the path should then be solved again. Throws
/// InputError; a request to stop is one.
std::int64_t recover_tags(const ClipContext& context, FrameSource& source, const GeometrySolution& geometry,
                          ClipObservations& clip);

}  // namespace matchlight
