// Which plate pixels a virtual thing can touch: screen bounds of world-space boxes and rectangles, through the lens.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "calibration/camera.h"
#include "compositor/lens_map.h"
#include "core/image.h"
#include "core/transforms.h"

namespace matchlight {

/// Points nearer than this are cut off; nothing filmed stands closer to the lens.
inline constexpr double near_plane_m = 0.01;

/// Bounds of a convex body in normalised camera coordinates (x/z, y/z), cut at the near plane and at the lens map's
/// bounds; empty where no part of it is before the camera or in view. `edges` index into `corners_world_m`.
Eigen::AlignedBox2d normalized_bounds(const std::vector<Eigen::Vector3d>& corners_world_m,
                                      const std::vector<std::array<int, 2>>& edges,
                                      const RigidTransform& camera_from_world, const LensMap& lens_map);

/// The same of a box and of a rectangle lying at height `z_m`.
Eigen::AlignedBox2d normalized_bounds_of_box(const Eigen::AlignedBox3d& box_world_m,
                                             const RigidTransform& camera_from_world, const LensMap& lens_map);
Eigen::AlignedBox2d normalized_bounds_of_rectangle(const Eigen::AlignedBox2d& rectangle_m, double z_m,
                                                   const RigidTransform& camera_from_world, const LensMap& lens_map);

/// The plate pixels whose directions can lie in `bounds`, grown by `margin_px` and cut to the frame.
Region plate_region(const Eigen::AlignedBox2d& bounds, const Camera& camera, int margin_px);

}  // namespace matchlight
