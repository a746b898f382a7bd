// A sphere set as triangles, for what casts and hides by meshes alone.
#pragma once

#include <cstddef>

#include "scene/model.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// More triangles than this are not made of a set.
constexpr std::size_t most_sphere_triangles = 4'000'000;

/// How often the faces of an octahedron are halved along each edge, 5 at most, so that `spheres` of them stay within
/// most_sphere_triangles: 2^n parts an edge, 8·4^n triangles a sphere. Empty where 2 halvings are too many.
std::optional<int> sphere_halvings(std::size_t spheres);

/// The spheres as octahedra with `halvings` of their edges, in the set's own axes and unit: half of what a part
/// deviates lies outside the sphere and half inside, 0.03 % of the radius each way at 5 halvings, 2 % at 2. Normals are
/// the sphere's own. One opaque material. `halvings`: 0 to 5, else std::invalid_argument.
Model mesh_of_spheres(const SphereSet& set, int halvings);

}  // namespace matchlight
