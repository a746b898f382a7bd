// The solve's pair, or the settings' own.
#include "compositor/focus.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compositor/nearest_known.h"
#include "render/virtual_layer.h"

namespace matchlight {

Focus focus_of_frame(const DepthOfFieldSettings& settings, const Solve& solve, const SolvedFrame& frame,
                     std::optional<double> focused_depth_m, Warnings& warnings) {
    std::optional<double> scale = settings.coc_scale_px_m, distance = focused_depth_m;
    if (!scale) scale = known_near(solve, frame, &SolvedFrame::coc_scale_px_m);
    if (!distance) distance = settings.focus_distance_m;
    if (!distance) distance = known_near(solve, frame, &SolvedFrame::focus_distance_m);
    if (!scale || !distance) {
        warnings.add(
            "depth of field is left out: neither the solve nor the scene says how far the lens is opened and where "
            "it is focused; give focus_distance_m and coc_scale_px_m");
        return {};
    }
    return {.coc_scale_px_m = *scale, .focus_distance_m = *distance};
}

CocRange coc_range_of_box(const Focus& focus, const Eigen::AlignedBox3d& box_world_m,
                          const RigidTransform& camera_from_world) {
    double nearest_m = std::numeric_limits<double>::infinity(), farthest_m = near_plane_m;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d corner = box_world_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
        const double z_m = (camera_from_world * corner).z();
        nearest_m = std::min(nearest_m, z_m);
        farthest_m = std::max(farthest_m, z_m);
    }
    return {.nearest_px = signed_coc_px(focus, std::max(nearest_m, near_plane_m)),
            .farthest_px = signed_coc_px(focus, farthest_m)};
}

}  // namespace matchlight
