// What other libraries make of the same corners: the poses that tracking is held against.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "core/transforms.h"
#include "tracking/tag_detector.h"
#include "tracking/tag_fit.h"

namespace matchlight {

/// Corners in tag_corners_m's order on the plane z = 1, the lens undone; nullopt where the lens does not reach one.
std::optional<TagCorners> normalized_corners(const TagDetection& detection, const Camera& camera);

/// camera_from_tag of AprilTag's estimate_tag_pose: a homography (Olson 2011), then orthogonal iteration (Lu, Hager &
/// Mjolsness 2000) from both planar minima (Schweighofer & Pinz 2006), the better of them.
RigidTransform apriltag_pose(const TagCorners& corners_normalized, double size_m);

/// camera_from_tag of OpenCV's SOLVEPNP_IPPE (Collins & Bartoli 2014), the solution that reprojects better; nullopt
/// where it finds none.
std::optional<RigidTransform> ippe_pose(const TagCorners& corners_normalized, double size_m);

/// A point of the world and where it is seen, on the plane z = 1.
struct SeenPoint {
    Eigen::Vector3d world_m;
    Eigen::Vector2d normalized;
};

/// camera_from_world of OpenCV's solvePnP over all points: IPPE where they lie in one plane, otherwise SQPnP (Terzakis
/// & Lourakis 2020), then Levenberg–Marquardt. nullopt with fewer than four or where it fails.
std::optional<RigidTransform> solve_pnp_pose(const std::vector<SeenPoint>& points);

}  // namespace matchlight
