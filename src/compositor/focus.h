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

/// What of the world a frame shows.
struct FrameView {
    RigidTransform camera_from_world = RigidTransform::Identity();
    Eigen::AlignedBox2d normalized;  // camera coordinates (x/z, y/z) of the whole frame
    double focal_px = 0;
};

/// Signed circles of confusion of that part of a box in world axes whose light can reach the frame through the lens:
/// what stands beside the camera may be closer than anything in the picture. Depths before the near plane count as
/// there.
CocRange coc_range_of_box(const Focus& focus, const Eigen::AlignedBox3d& box_world_m, const FrameView& view);

}  // namespace matchlight
