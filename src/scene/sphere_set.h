// A set of spheres: atoms, particles, grains, by the million.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace matchlight {

/// 16 bytes, as the GPU reads them.
struct Sphere {
    std::array<float, 3> centre_m;  // the set's own axes, z up
    float radius_m;                 // above 0
};
static_assert(sizeof(Sphere) == 16);

/// What all spheres have in common is not kept for each: 27 million of one colour take 16 bytes each and no more.
struct SphereSet {
    std::string name;
    std::vector<Sphere> spheres;
    std::vector<std::array<std::uint8_t, 4>> colors;  // sRGB-coded, the fourth unused; empty: all have `color`
    std::vector<float> opacities;                     // 0..1; empty: all have `opacity`
    std::array<float, 3> color{0.8F, 0.8F, 0.8F};     // scene-linear
    float opacity = 1;
    Eigen::AlignedBox3d bounds_m;  // of the spheres, not of their centres alone

    std::vector<std::string> columns;  // what else its file says of each sphere, by name

    std::size_t size() const { return spheres.size(); }
    /// What the spheres take in memory.
    std::size_t bytes() const;
    /// Whether any sphere lets light through.
    bool blends() const;
    /// Makes `bounds_m` the box of all spheres.
    void update_bounds();
};

}  // namespace matchlight
