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

/// Index of the chosen candidate of each frame, nullopt where there is none: Viterbi (1967) over at most two states.
/// A state costs its robust reprojection cost; a change costs by how far the direction from which the camera sees
/// `target_world_m` departs from where the surviving path expected it, in standard deviations. That direction swings by
/// twice the tilt when a tag flips, and not at all when the camera pans. Every survivor carries its own expectation, a
/// random walk filtered over its past (per-survivor processing; Raheli, Polydoros & Tzou 1995), so that one frame in
/// which both poses are poor is no bridge to the wrong branch. Cuts are affordable: a clip may hold several shots.
std::vector<std::optional<std::size_t>> choose_branches(const std::vector<PoseCandidates>& frames,
                                                        const Eigen::Vector3d& target_world_m);

}  // namespace matchlight
