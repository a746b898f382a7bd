// Chooses, over the whole clip, which of a frame's two planar poses is the true one.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tracking/camera_pose.h"

namespace matchlight {

/// What may have been the pose at one time; empty where nothing was seen.
struct PoseCandidates {
    double time_s = 0;
    std::vector<CameraPose> poses;
};

/// Index of the chosen candidate of each frame (Viterbi 1967 over at most two states), nullopt where there is none.
/// A state costs its robust reprojection cost; a change costs by the angle through which the camera would have moved
/// around `target_world_m` between frames: that swings by twice the tilt when a tag flips, and hardly at all when the
/// camera pans. Cuts are affordable, so a clip may hold several shots.
std::vector<std::optional<std::size_t>> choose_branches(const std::vector<PoseCandidates>& frames,
                                                        const Eigen::Vector3d& target_world_m);

}  // namespace matchlight
