// How well the tags of a clip agree, which needs no truth: reprojection, and leaving one tag out.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "calibration/camera.h"
#include "report/track_report.h"
#include "tracking/camera_pose.h"
#include "tracking/rig_solve.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// The tags of a frame that have a place, each id once: the first.
std::vector<PlacedObservation> placed(const FrameObservations& frame, const std::vector<SolvedTag>& rig);

/// camera_from_world from some tags of a frame; `known` is the pose that all of them have.
using PoseOfTags = std::function<std::optional<RigidTransform>(const std::vector<PlacedObservation>& tags,
                                                               const RigidTransform& known)>;

/// Every tag is left out in turn of every frame that shows two or more, and its corners are predicted from the others'
/// pose. Places stay those of the whole clip. `poses` are by frame, as `frames` are.
TagAgreement tag_agreement(const std::vector<FrameObservations>& frames, const std::vector<SolvedFrame>& poses,
                           const std::vector<SolvedTag>& rig, const Camera& camera, const PoseOfTags& pose_of);

}  // namespace matchlight
