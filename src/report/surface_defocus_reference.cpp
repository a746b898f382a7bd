// All rays of a pixel meet in the plane of focus.
#include "report/surface_defocus_reference.h"

#include <cmath>

#include "render/effects/bokeh.h"

namespace matchlight {

Eigen::Vector3d reference_surface_ratio(const SurfaceLensView& view, const Eigen::Vector2d& normalized,
                                        const SurfaceRatio& ratio) {
    const RigidTransform world_from_camera = view.camera_from_world.inverse();
    const Eigen::Vector3d up = view.camera_from_world.linear().col(2);  // the surface's normal in the camera's axes
    const double height_m = view.surface_z_m - world_from_camera.translation().z();
    const double opening_radius_m = view.focus.coc_scale_px_m / view.focal_px / 2;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int rays = 0;
    for (int j = 0; j < view.lens_steps; ++j) {
        for (int i = 0; i < view.lens_steps; ++i) {
            const Eigen::Vector2d point((2 * i + 1.0) / view.lens_steps - 1, (2 * j + 1.0) / view.lens_steps - 1);
            if (bokeh_distance(view.bokeh, point) > 1) continue;
            ++rays;
            // What is beyond the focus shows the opening upright (bokeh.h): light from the point comes in there.
            const Eigen::Vector3d on_lens_m(opening_radius_m * point.x(), opening_radius_m * point.y(), 0);
            const Eigen::Vector3d direction = normalized.homogeneous() - on_lens_m / view.focus.focus_distance_m;
            const double depth_m = (height_m - up.dot(on_lens_m)) / up.dot(direction);
            if (!(depth_m > 0) || !std::isfinite(depth_m)) {
                sum += Eigen::Vector3d::Ones();
                continue;
            }
            const Eigen::Vector3d hit_m = world_from_camera * (on_lens_m + depth_m * direction);
            sum += ratio(hit_m.head<2>());
        }
    }
    return sum / rays;
}

}  // namespace matchlight
