// Surfaces over the unit square, laid out as grids of triangles.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "scene/model.h"

namespace matchlight {

struct SurfacePoint {
    Eigen::Vector3d position;
    Eigen::Vector3d normal;  // unit length
    Eigen::Vector2d uv;
};
/// A point of a surface over the unit square; seen from outside, u grows to the right and v downwards.
using GridSurface = std::function<SurfacePoint(double u, double v)>;

void add_surface(ModelMesh& mesh, int columns, int rows, const GridSurface& surface);

/// Silhouettes of this many straight pieces leave a circle of 200 pixels radius by 0.03 pixels.
inline constexpr int pieces_around = 192;

}  // namespace matchlight
