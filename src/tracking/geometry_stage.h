// The geometry of a clip: where the tags are, where the camera was, and what its lens is.
#pragma once

#include "calibration/camera.h"
#include "tracking/camera_path.h"
#include "tracking/clip_context.h"
#include "tracking/clip_observations.h"
#include "tracking/rig_solve.h"
#include "tracking/solve_file.h"

namespace matchlight {

struct GeometrySolution {
    Camera camera;  // the calibrated one, or as the clip refines it
    std::vector<LensParameter> lens_parameters;
    RigSolution rig;
    CameraPath path;
    std::optional<double> readout_s;        // where it was asked for and the camera moved enough
    std::optional<double> readout_sigma_s;  // where it was asked for
    std::vector<double> leave_one_out_px;   // of every sighting in some hundred frames, by the other tags of its frame
};

/// Rig, path and, from level normal on, their adjustment over the whole clip; the lens too where the scene gives none.
/// Adds no warnings: it may run again when more tags have been found. Throws InputError: the clip does not tell the
/// focal length of an unknown lens.
GeometrySolution solve_geometry(const ClipContext& context, const ClipObservations& clip);

/// Writes rig, lens, poses and their confidence to the solve, counts them in the summary and warns of what is doubtful.
void report_geometry(const ClipContext& context, const GeometrySolution& geometry, Solve& solve, TrackSummary& summary);

}  // namespace matchlight
