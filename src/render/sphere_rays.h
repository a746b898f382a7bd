// How a set of spheres is looked at, in its own axes.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "gl/program.h"
#include "render/sphere_cover.h"
#include "scene/sphere_cells.h"

namespace matchlight {

/// From the origin of a perspective (reversed z, infinitely far; clip w is metres along the camera's z), or along
/// parallel rays (clip w is 1; depth 0..1, the nearest 1).
struct SphereProjection {
    Eigen::Matrix4d clip_from_world = Eigen::Matrix4d::Identity();
    int width = 0, height = 0;  // pixels
    bool is_parallel = false;
};

/// A view in the axes of a set that stands at `world_from_model`: a rotation, a translation and one scale.
class SphereRays {
public:
    SphereRays(const SphereProjection& view, const Eigen::Matrix4d& world_from_model);

    /// The uniforms of shaders/spheres/ray.glsl and sphere.vert, but for `first_id`.
    void set(Program& program) const;
    /// Floats do not tell the rays of neighbouring pixels apart: spheres take programs with LONG_LENS.
    bool is_long_lens() const;

    /// What of the view a cell is in.
    enum class Place {
        outside,
        small,  // wholly inside, each sphere within a few pixels: they can be drawn as points
        large   // at the edge, before the near plane, or of large spheres
    };
    Place place(const SphereCell& cell) const;
    /// Of one that is not outside; all of the picture where it reaches before the near plane.
    CellInPicture in_picture(const SphereCell& cell) const;
    /// Of a cell that is small: no sphere of it is drawn larger.
    double largest_radius_px(const SphereCell& cell) const;
    /// The depth of its nearest corner; more than 1 before the near plane.
    double nearest_depth(const SphereCell& cell) const;

private:
    Eigen::Vector3d origin() const;
    double radius_px(const SphereCell& cell, double nearest_w) const;

    Eigen::Matrix4d clip_from_model_;
    Eigen::Matrix3d ray_from_ndc_;
    int width_, height_;
    bool is_parallel_;
};

}  // namespace matchlight
