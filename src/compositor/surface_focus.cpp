// The circle is an affine function of the pixel but for the lens' distortion: corners bound a tile.
#include "compositor/surface_focus.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace matchlight {

SurfaceFocus::SurfaceFocus(const Focus& focus, double surface_z_m, const RigidTransform& camera_from_world,
                           const LensMap& lens_map, const Camera& camera)
    : focus_(focus),
      up_(camera_from_world.linear().col(2)),
      height_m_(surface_z_m - camera_from_world.inverse().translation().z()),
      lens_map_(&lens_map),
      focal_px_(std::sqrt(camera.fx * camera.fy)),
      largest_px_(widest_surface_coc_px(camera.width, camera.height)) {}

double SurfaceFocus::bare_coc_px(const Eigen::Vector2d& normalized) const {
    const double per_m = up_.dot(normalized.homogeneous()) / height_m_;
    return focus_.coc_scale_px_m * (1 / focus_.focus_distance_m - per_m);
}

double SurfaceFocus::coc_px(double x, double y) const {
    const Eigen::Vector2d here = lens_map_->normalized(x, y);
    Eigen::Matrix2d normalized_by_pixel;
    normalized_by_pixel << lens_map_->normalized(x + 1, y) - here, lens_map_->normalized(x, y + 1) - here;
    const double magnification = 1 / (focal_px_ * std::sqrt(std::abs(normalized_by_pixel.determinant())));
    const double width_px = magnification * bare_coc_px(here);
    return std::isnan(width_px) ? width_px : std::clamp(width_px, -largest_px_, largest_px_);
}

SurfaceTile SurfaceFocus::over(const Region& part) const {
    double least = largest_px_, most = -largest_px_;
    for (const int x : {part.x, part.x + part.width - 1}) {
        for (const int y : {part.y, part.y + part.height - 1}) {
            const double width_px = coc_px(x, y);
            if (std::isnan(width_px)) return {part, 0, largest_px_};
            least = std::min(least, width_px);
            most = std::max(most, width_px);
        }
    }
    // What the lens bends between corners.
    constexpr double slack = 0.02;
    const bool crosses_focus = least <= 0 && most >= 0;
    return {part, crosses_focus ? 0 : (1 - slack) * std::min(std::abs(least), std::abs(most)),
            std::min((1 + slack) * std::max(std::abs(least), std::abs(most)), largest_px_)};
}

int SurfaceFocus::class_of_texels(const Region& part, double texel_m) const {
    const auto seen_m = [&](int x, int y) -> Eigen::Vector3d {
        const Eigen::Vector3d ray = lens_map_->normalized(x, y).homogeneous();
        const double depth_m = height_m_ / up_.dot(ray);
        return depth_m > 0 ? Eigen::Vector3d(depth_m * ray)
                           : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    };
    // A pixel spans most where the surface is seen most aslant: at one of the corners.
    double widest_m = 0;
    for (const int x : {part.x, part.x + part.width - 1}) {
        for (const int y : {part.y, part.y + part.height - 1}) {
            for (const Eigen::Vector2i& step : {Eigen::Vector2i(1, 0), Eigen::Vector2i(0, 1), Eigen::Vector2i(1, 1)}) {
                const double spans_m = (seen_m(x + step.x(), y + step.y()) - seen_m(x, y)).norm();
                if (!std::isfinite(spans_m)) return 0;
                widest_m = std::max(widest_m, spans_m);
            }
        }
    }
    const double texel_px = texel_m / std::max(widest_m, 1e-12);
    return texel_px < 2 ? 0 : static_cast<int>(std::min<double>(std::log2(texel_px), coarsest_smooth_class));
}

int SurfaceFocus::reach_px(const Region& part, int least_class, const SurfaceDefocusKnobs& knobs) const {
    const SurfaceTile tile = over(part);
    if (tile.widest_px < least_coc_px) return 0;
    const double change = std::hypot((coc_px(part.x + part.width, part.y) - coc_px(part.x, part.y)) / part.width,
                                     (coc_px(part.x, part.y + part.height) - coc_px(part.x, part.y)) / part.height);
    constexpr double any_change = 2;  // surface_reach_px: as much as it goes to
    return static_cast<int>(
        std::ceil(surface_reach_px(tile.widest_px, std::isnan(change) ? any_change : change, least_class, knobs)));
}

}  // namespace matchlight
