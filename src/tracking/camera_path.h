// The camera's path over the clip: one pose a frame from the placed tags, the right branch, gaps bridged or left.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "calibration/camera.h"
#include "scene/scene_file.h"
#include "tracking/camera_pose.h"
#include "tracking/rig_solve.h"

namespace matchlight {

struct PathFrame {
    std::int64_t frame = 0;
    double time_s = 0;
    std::optional<CameraPose> pose;
    double reprojection_px = 0;          // RMS; of frames with tags
    double confidence = 0;               // 0..1
    std::vector<int> tags;               // ids the pose rests on
    std::vector<std::size_t> sightings;  // the same as indices into FrameObservations::tags
    bool bridged = false;                // between its neighbours, without a tag
    // Why the confidence is low.
    bool small = false, grazing = false, cut_off = false, disagreeing = false;
    bool seen_twice = false;
    bool outvoted = false;  // a tag was left out because the others contradict it
};

struct CameraPath {
    std::vector<PathFrame> frames;
    std::int64_t bridged = 0, missing = 0;
};

/// What is said of a frame whose pose rests on `tags`: RMS, confidence and the reasons why it is low.
void describe_frame(PathFrame& frame, const std::vector<PlacedObservation>& tags, const CameraPose& pose,
                    const Camera& camera);

/// `world_from_tag` holds the places of the rig (RigSolution). Ids that a frame shows twice are resolved by the other
/// tags, or by where the tag was before.
CameraPath solve_path(const std::vector<RigTag>& rig, const std::map<int, RigidTransform>& world_from_tag,
                      const std::vector<FrameObservations>& frames, const Camera& camera);

/// Fills runs of frames without a pose between two with one, if they are short: up to 5 frames and ¼ s. Positions and
/// turns follow a cubic that meets both neighbours' velocities (Hermite, in the tangent space of the first);
/// covariance grows towards the middle by what the cubic and the straight line disagree on.
void bridge_gaps(CameraPath& path);

}  // namespace matchlight
