// The double-precision reference of the surface out of focus: a ray through every part of the lens' opening.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "calibration/thin_lens.h"
#include "core/transforms.h"
#include "scene/effects.h"

namespace matchlight {

/// The plane z = `surface_z_m` of the world before a thin lens.
struct SurfaceLensView {
    RigidTransform camera_from_world = RigidTransform::Identity();
    double surface_z_m = 0;
    Focus focus;
    double focal_px = 1;
    BokehSettings bokeh;
    int lens_steps = 64;  // along a side of the square around the opening
};

/// The share of the surface's light that is left at a point of it (world x, y).
using SurfaceRatio = std::function<Eigen::Vector3d(const Eigen::Vector2d& point_m)>;

/// Its mean over the opening, seen along the direction (x/z, y/z); rays that miss the surface count 1.
Eigen::Vector3d reference_surface_ratio(const SurfaceLensView& view, const Eigen::Vector2d& normalized,
                                        const SurfaceRatio& ratio);

}  // namespace matchlight
