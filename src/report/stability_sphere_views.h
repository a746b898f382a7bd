// Spheres and cameras that the stiff cases of sphere sets share.
#pragma once

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "report/sphere_reference.h"
#include "report/stability_cases.h"
#include "scene/sphere_set.h"

namespace matchlight {

inline constexpr int sphere_case_side_px = 96;

inline ReferenceView view_from(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& target_m, double focal_px,
                               double near_m) {
    ReferenceView view;
    view.camera_from_world = camera_looking_along(eye_m, (target_m - eye_m).normalized());
    view.pinhole = {.fx = focal_px,
                    .fy = focal_px,
                    .cx = (sphere_case_side_px - 1) / 2.0,
                    .cy = (sphere_case_side_px - 1) / 2.0,
                    .width = sphere_case_side_px,
                    .height = sphere_case_side_px,
                    .near_m = near_m};
    return view;
}

inline SphereSet set_of(std::vector<Sphere> spheres) {
    SphereSet set;
    set.spheres = std::move(spheres);
    set.update_bounds();
    return set;
}

inline Sphere sphere_at(const Eigen::Vector3d& centre_m, double radius_m) {
    const Eigen::Vector3f centre = centre_m.cast<float>();
    return {{centre.x(), centre.y(), centre.z()}, static_cast<float>(radius_m)};
}

/// One metre away from the eye, and filling some of the picture, by a long lens if need be.
struct OneSphere {
    SphereSet set;
    ReferenceView view;
};

inline OneSphere one_sphere(double radius_m) {
    // Its top is the origin; huge ones stay where floats can hold both top and centre.
    const Eigen::Vector3d centre(0, 0, -radius_m);
    const Eigen::Vector3d toward_eye = Eigen::Vector3d(0.48, -0.6, 0.64);
    const double half_px = 0.35 * sphere_case_side_px, focal_px = half_px / std::min(radius_m, 0.35);
    return {set_of({sphere_at(centre, radius_m)}),
            view_from(toward_eye, radius_m < 1 ? centre : Eigen::Vector3d(0, 0, 0), focal_px, 0.01)};
}

/// Some by chance, some upon each other.
inline SphereSet cloud() {
    std::mt19937 random(5);
    const auto along = [&] { return static_cast<double>(random()) * 0x1p-32 - 0.5; };
    SphereSet set;
    for (int i = 0; i < 60; ++i) {
        const Sphere one = sphere_at({along(), along(), along()}, 0.1 + 0.1 * (along() + 0.5));
        set.spheres.insert(set.spheres.end(), i % 6 == 0 ? 3 : 1, one);
    }
    set.update_bounds();
    return set;
}

/// Layers of spheres that let light through (report/stability_sphere_layers.cpp).
void add_sphere_layer_cases(std::vector<StabilityCase>& cases);
/// How spheres are lit, covered and darkened there (report/stability_sphere_light.cpp).
void add_sphere_light_cases(std::vector<StabilityCase>& cases);

}  // namespace matchlight
