// Where the picture of the real surface lies: the part of its plane that the clip sees well, in texels as fine as seen.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "compositor/lens_map.h"
#include "core/transforms.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// How wide, at a point of the plane, a pixel is.
struct PlanePixel {
    double across_m = 0;  // at right angles to the line of sight
    double along_m = 0;   // the way the line of sight leans
    bool seen = false;    // false: the plane is edge-on, or seen from below
};
PlanePixel plane_pixel(const Eigen::Vector3d& point_m, const Eigen::Vector3d& eye_m, double focal_px);

/// Square texels over a rectangle of the plane z = z_m.
struct PlaneGrid {
    Eigen::AlignedBox2d rectangle_m;
    double texel_m = 0;
    double z_m = 0;
    int columns = 0, rows = 0;  // 0: no frame sees the plane

    Eigen::Vector3d point_m(double column, double row) const {
        return {rectangle_m.min().x() + (column + 0.5) * texel_m, rectangle_m.min().y() + (row + 0.5) * texel_m, z_m};
    }
};

/// Texels are as wide as the pixels that show the rig's tags most finely (of a rig out of sight: the plane); the
/// rectangle holds what is seen at most 16 times as coarsely. Where that is more than `most_texels` a side texels grow
/// up to twofold, and then the rectangle ends, the rig in its middle.
PlaneGrid plan_plane_grid(const std::vector<RigidTransform>& cameras_from_world, const Solve& solve,
                          const LensMap& lens_map, double z_m, int most_texels);

}  // namespace matchlight
