// A sphere set as triangles, for what hides and is shaded by meshes alone.
#pragma once

#include <cstddef>
#include <optional>

#include "scene/model.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// No more triangles than this are made of a set: light is kept for each vertex.
inline constexpr std::size_t most_sphere_triangles = 1'000'000;
inline constexpr int fewest_sphere_halvings = 2, most_sphere_halvings = 5;

/// How many triangles a sphere has whose octahedron's edges are halved so often: 8·4ⁿ.
constexpr std::size_t sphere_triangles(int halvings) {
    return std::size_t{8} << (2 * halvings);
}

/// The most halvings with which so many spheres keep within most_sphere_triangles; nullopt where the fewest are too
/// many.
std::optional<int> sphere_halvings(std::size_t spheres);

/// Each sphere as an octahedron, its edges halved 0 to 5 times and pushed out to the sphere (2 to 5 as
/// sphere_halvings() chooses), in the set's own axes and unit. Corners lie as far outside the sphere as the middles of
/// the largest faces lie inside: 0.05 % of the radius with 5 halvings, 3 % with 2. Normals are the sphere's. One
/// opaque material of the set's own colour; spheres' own colours are the vertices'.
Model mesh_of_spheres(const SphereSet& set, int halvings);

}  // namespace matchlight
