// The footage tracked with other libraries' poses, frame by frame: AprilTag's of one tag, OpenCV's of all.
#pragma once

#include <optional>
#include <vector>

#include "calibration/camera.h"
#include "core/warnings.h"
#include "scene/scene_file.h"
#include "tracking/camera_pose.h"
#include "tracking/rig_solve.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// What AprilTag's library looks at: code values as they are, or linear light.
enum class PeerPixels { codes, light };

struct PeerPoses {
    std::vector<SolvedFrame> one_tag;       // AprilTag's own pose of the largest tag
    std::vector<SolvedFrame> all_tags;      // solvePnP over the corners of all
    std::vector<FrameObservations> frames;  // the library's corners
};

/// What these libraries make of some tags of one frame.
std::optional<RigidTransform> apriltag_pose_of_largest(const std::vector<PlacedObservation>& tags);
std::optional<RigidTransform> solve_pnp_pose_of(const std::vector<PlacedObservation>& tags);

/// Decodes the clip and searches every frame whole, on all cores. `rig` holds the places of the tags, which these
/// libraries do not find. Throws InputError.
PeerPoses track_with_peers(const Scene& scene, const Camera& camera, const std::vector<SolvedTag>& rig,
                           PeerPixels pixels, Warnings& warnings);

}  // namespace matchlight
