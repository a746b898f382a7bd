// What a set of spheres tells of all of them.
#include "scene/sphere_set.h"

#include <algorithm>

namespace matchlight {

bool SphereSet::blends() const {
    if (opacities.empty()) return opacity < 1;
    return std::ranges::any_of(opacities, [](float one) { return one < 1; });
}

std::size_t SphereSet::bytes() const {
    return spheres.size() * sizeof(Sphere) + colors.size() * sizeof(colors[0]) + opacities.size() * sizeof(float);
}

void SphereSet::update_bounds() {
    bounds_m.setEmpty();
    for (const Sphere& sphere : spheres) {
        const Eigen::Vector3d centre = Eigen::Vector3f(sphere.centre_m.data()).cast<double>();
        const Eigen::Vector3d reach = Eigen::Vector3d::Constant(sphere.radius_m);
        bounds_m.extend(centre - reach);
        bounds_m.extend(centre + reach);
    }
}

}  // namespace matchlight
