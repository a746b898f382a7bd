// Exposure, white balance, response, vignetting and noise of a clip, from its tags as grey cards.
#pragma once

#include <map>
#include <vector>

#include "tracking/clip_context.h"
#include "tracking/clip_observations.h"
#include "tracking/geometry_stage.h"
#include "tracking/photometry.h"

namespace matchlight {

/// What each tag would send to the camera under the probe; what the probe shows of the tags themselves comes first,
/// then the tags nearest its place.
std::map<int, CardExpectation> card_expectations(const ClipContext& context, const RigSolution& rig);

/// The response that the readings of a clip tell; sRGB, with a warning, where they do not.
Response solved_response(const Scene& scene, const std::vector<std::vector<CardReading>>& cards, Warnings& warnings,
                         PhotometrySummary& summary);

/// Fills the photometry of `solve`, whose frames are those of the clip.
void solve_photometry_stage(const ClipContext& context, const ClipObservations& clip, const GeometrySolution& geometry,
                            Solve& solve, TrackSummary& summary);

}  // namespace matchlight
