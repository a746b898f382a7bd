// The geometry of a clip: where the tags are, where the camera was, and what its lens is.
#pragma once

#include "calibration/camera.h"
#include "tracking/camera_path.h"
#include "tracking/clip_context.h"
#include "tracking/clip_observations.h"
#include "tracking/rig_solve.h"

namespace matchlight {

struct GeometrySolution {
    Camera camera;  // the calibrated one, or as the clip refines it
    RigSolution rig;
    CameraPath path;
};

/// Rig, then path, from what was seen. Adds no warnings: it may run again when more tags have been found.
GeometrySolution solve_geometry(const ClipContext& context, const ClipObservations& clip);

/// Writes rig, lens, poses and their confidence to the solve, counts them in the summary and warns of what is doubtful.
void report_geometry(const ClipContext& context, const GeometrySolution& geometry, Solve& solve, TrackSummary& summary);

}  // namespace matchlight
