// Directions spread evenly over the sphere, opposite ones in pairs, and the light of a probe that each stands for.
#pragma once

#include <array>
#include <vector>

#include "lighting/probe.h"

namespace matchlight {

/// By how often the faces of an octahedron are divided in four: 2 + 4^(n + 1).
inline constexpr std::array octahedral_counts{6, 18, 66, 258, 1026};
inline constexpr int most_octahedral_divisions = 4;

/// The corners of the divided octahedron, of unit length; each one of odd number is the opposite of the one before it.
std::vector<Eigen::Vector3d> octahedral_directions(int divisions);

/// The same with the light of all directions that are nearer to each than to others.
std::vector<DirectionalSample> sample_octahedrally(const Probe& probe, int divisions);

}  // namespace matchlight
