// What a triangle mesh needs before it is drawn: no bad triangles, normals, tangents, each vertex once.
#pragma once

#include <cstddef>

#include "scene/model.h"

namespace matchlight {

/// Drops triangles with a corner that is not finite, and those without area. Returns how many.
std::size_t drop_bad_triangles(ModelMesh& mesh);

/// Smooth normals with creases: at each corner the mean of the normals of the triangles around it that turn from its
/// own by no more than `crease_deg`, weighted by their angle there (Thürmer & Wüthrich, Computing vertex normals from
/// polygonal facets, 1998). Triangles are neighbours where their positions are equal, whatever their other attributes.
void compute_normals(ModelMesh& mesh, double crease_deg);

/// Gives vertices whose normal is zero or not finite that of the triangles that use them. Returns how many.
std::size_t repair_normals(ModelMesh& mesh);

/// Tangents along growing u of the texture that lies as `mapping` says, w = +1 where cross(normal, tangent) points up
/// in the image, as glTF has it. Weighted by angle over the triangles that share the vertex; vertices between mirrored
/// halves of the texture are split (after Mikkelsen, Simulation of wrinkled surfaces revisited, 2008).
void compute_tangents(ModelMesh& mesh, const UvMapping& mapping = {});

/// Gives vertices whose tangent is zero or along the normal one of computed directions: that of compute_tangents()
/// where their triangles have an area in the texture. Returns how many.
std::size_t repair_tangents(ModelMesh& mesh, const UvMapping& mapping = {});

/// Keeps each distinct vertex once, and none that no triangle uses. Exact: no two different vertices become one.
void weld(ModelMesh& mesh);

/// Halfway between two vertices of one edge.
ModelVertex middle_of_edge(const ModelVertex& a, const ModelVertex& b);

/// The same vertex for the other side of the surface.
ModelVertex back_of(const ModelVertex& vertex);

}  // namespace matchlight
