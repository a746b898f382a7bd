// Poses of all frames under the model of the clip and of the motion.
#pragma once

#include <vector>

#include "tracking/camera_path.h"
#include "tracking/shared_normal.h"

namespace matchlight {

/// A clip's model, what is free of it, and the covariance of that.
struct SolvedModel {
    const ClipModel& model;
    const ModelFreedom& freedom;
    const SharedColumns& columns;
    const Eigen::MatrixXd& covariance;
};

/// Each frame's pose from its own tags, then smoothed over the clip by smooth_path; covariances are marginal over all
/// that is shared. Short gaps take the smooth path's prediction, as far as it is worth drawing by. `frames` are
/// parallel to the path's.
void refine_path(const SolvedModel& solved, std::vector<BundleFrame>& frames, CameraPath& path);

/// Velocities of the frames from their neighbours' poses, for rolling shutters.
void set_velocities(const CameraPath& path, std::vector<BundleFrame>& frames);

/// Every tag of `frames` predicted by the pose of the frame's other tags: RMS of its corners in pixels, one a sighting.
std::vector<double> leave_one_out_px(const ClipModel& model, const ModelFreedom& freedom,
                                     const std::vector<BundleFrame>& frames);

}  // namespace matchlight
