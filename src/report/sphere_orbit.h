// The cameras that sphere sets are measured from: a turn around the whole set, and one close to it.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "report/sphere_reference.h"

namespace matchlight {

/// A turn about the middle of a box, looking at it from 20° above with a vertical angle of 40°. tests/benchmark's
/// peer_vtk_spheres.py takes the same.
struct SphereOrbit {
    std::string name;
    double distance = 3;  // of the camera from the middle, in half diagonals of the box
};
inline const std::vector<SphereOrbit>& sphere_orbits() {
    static const std::vector<SphereOrbit> orbits{{"whole", 3}, {"near", 1}};
    return orbits;
}

/// `turn` 0..1 of the orbit; a square picture of `side_px`. The near plane is a thousandth of the box's half diagonal
/// away, and no nearer than rounding lets a box of one point have one.
ReferenceView orbit_view(const Eigen::AlignedBox3d& bounds_m, const SphereOrbit& orbit, double turn, int side_px);

}  // namespace matchlight
