// Places cameras on a circle.
#include "report/sphere_orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace matchlight {

ReferenceView orbit_view(const Eigen::AlignedBox3d& bounds_m, const SphereOrbit& orbit, double turn, int side_px) {
    constexpr double elevation = 20 * std::numbers::pi / 180, angle = 40 * std::numbers::pi / 180;
    constexpr double least_reach_m = 1e-6;
    const bool is_empty = bounds_m.isEmpty();
    const double reach_m = is_empty ? 1 : std::max(bounds_m.diagonal().norm() / 2, least_reach_m);
    const Eigen::Vector3d middle_m = is_empty ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : bounds_m.center();
    const double azimuth = 2 * std::numbers::pi * turn;
    const Eigen::Vector3d outward(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                  std::sin(elevation));
    ReferenceView view;
    view.camera_from_world = camera_looking_along(middle_m + orbit.distance * reach_m * outward, -outward);
    const double focal_px = side_px / (2 * std::tan(angle / 2));
    view.pinhole = {.fx = focal_px,
                    .fy = focal_px,
                    .cx = (side_px - 1) / 2.0,
                    .cy = (side_px - 1) / 2.0,
                    .width = static_cast<double>(side_px),
                    .height = static_cast<double>(side_px),
                    .near_m = 1e-3 * reach_m};
    return view;
}

}  // namespace matchlight
