// Sets of spheres for the tests of how they are drawn.
#pragma once

#include <array>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "scene/scene_file.h"
#include "scene/sphere_set.h"

namespace matchlight::test {

inline SphereSet set_of(std::vector<Sphere> spheres) {
    SphereSet set;
    set.name = "test";
    set.spheres = std::move(spheres);
    set.color = {1, 1, 1};  // as meshes have it
    set.update_bounds();
    return set;
}

/// In a unit cube about the origin.
inline SphereSet random_set(std::size_t count, float least_radius, float most_radius) {
    std::mt19937_64 random(7);
    const auto uniform = [&] { return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53); };
    std::vector<Sphere> spheres(count);
    for (Sphere& sphere : spheres) {
        for (float& along : sphere.centre_m) along = uniform() - 0.5F;
        sphere.radius_m = least_radius + (most_radius - least_radius) * uniform();
    }
    return set_of(std::move(spheres));
}

/// Sends out the same light everywhere and mirrors none.
inline MaterialOverride glowing(const std::array<double, 3>& light) {
    MaterialOverride material;
    material.diffuse = material.specular = {0, 0, 0};
    material.emissive = light;
    return material;
}

}  // namespace matchlight::test
