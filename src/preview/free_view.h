// A camera that a hand leads around the scene: it looks at a point, upright.
#pragma once

#include <Eigen/Core>

#include "core/transforms.h"
#include "scene/virtual_camera.h"

namespace matchlight {

/// From where a camera stands, looking at what is so far before it.
CameraView view_of_pose(const RigidTransform& camera_from_world, double distance_m);
RigidTransform pose_of_view(const CameraView& view);

/// About the point that it looks at: to the left about the vertical, then up; it never comes to look straight up or
/// down, where left and right are none.
CameraView turned(const CameraView& view, double left_rad, double up_rad);
/// Both points, in the picture's own directions.
CameraView shifted(const CameraView& view, double right_m, double up_m);
/// The eye alone: `factor` of its distance from the point.
CameraView at_distance(const CameraView& view, double factor);

}  // namespace matchlight
