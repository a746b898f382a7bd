// How the lens is focused in a frame, and what that does to the objects in view.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "calibration/thin_lens.h"
#include "core/transforms.h"
#include "core/warnings.h"
#include "render/effects/depth_of_field.h"
#include "scene/effects.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// Of the settings where they say, else of the solve (frames that do not know take their nearest neighbour's). Scale 0,
/// and a warning, where neither knows the size of the opening or the distance. `focused_depth_m` is what autofocus
/// found along the camera's axis, instead of either's distance.
Focus focus_of_frame(const DepthOfFieldSettings& settings, const Solve& solve, const SolvedFrame& frame,
                     std::optional<double> focused_depth_m, Warnings& warnings);

/// Signed circles of confusion of a box in world axes; depths before the near plane count as there.
CocRange coc_range_of_box(const Focus& focus, const Eigen::AlignedBox3d& box_world_m,
                          const RigidTransform& camera_from_world);

}  // namespace matchlight
