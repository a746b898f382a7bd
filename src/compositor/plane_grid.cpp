// Looks along a few hundred pixels of every frame.
#include "compositor/plane_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace matchlight {

namespace {

/// Seen more coarsely than this many texels the surface is no better known than by the probe.
constexpr double coarsest_pixel = 16;
/// Sizes are multiples of this, so that halved mip levels cover the same rectangle.
constexpr int size_step = 64;

struct SeenPoint {
    Eigen::Vector2d place_m;
    PlanePixel pixel;
};

std::vector<SeenPoint> seen_points(const std::vector<RigidTransform>& cameras_from_world, const Camera& camera,
                                   const LensMap& lens_map, double z_m) {
    constexpr int columns = 33, rows = 25;
    std::vector<SeenPoint> points;
    for (const RigidTransform& camera_from_world : cameras_from_world) {
        const RigidTransform world_from_camera = camera_from_world.inverse();
        const Eigen::Vector3d eye_m = world_from_camera.translation();
        for (int i = 0; i < columns * rows; ++i) {
            const double x = (camera.width - 1.0) * (i % columns) / (columns - 1.0);
            const double y = (camera.height - 1.0) * std::floor(i / double{columns}) / (rows - 1.0);
            const Eigen::Vector2d normalized = lens_map.normalized(x, y);
            if (!normalized.allFinite()) continue;
            const Eigen::Vector3d direction = world_from_camera.linear() * normalized.homogeneous();
            const double distance = (z_m - eye_m.z()) / direction.z();
            if (!(distance > 0) || !std::isfinite(distance)) continue;
            const Eigen::Vector3d point_m = eye_m + distance * direction;
            const PlanePixel pixel = plane_pixel(point_m, eye_m, camera.fx);
            if (pixel.seen) points.push_back({point_m.head<2>(), pixel});
        }
    }
    return points;
}

double lower_quartile(std::vector<double> values) {
    const auto quarter = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
    std::ranges::nth_element(values, quarter);
    return *quarter;
}

/// Widths of the pixels that show the rig's tags.
std::vector<double> widths_at_tags_m(const std::vector<RigidTransform>& cameras_from_world, const Solve& solve,
                                     double z_m) {
    std::vector<double> widths;
    for (const RigidTransform& camera_from_world : cameras_from_world) {
        const Eigen::Vector3d eye_m = camera_from_world.inverse().translation();
        for (const SolvedTag& tag : solve.rig) {
            Eigen::Vector3d point_m = tag.world_from_tag.translation();
            point_m.z() = z_m;
            const Eigen::Vector3d in_camera = camera_from_world * point_m;
            if (!(in_camera.z() > 0)) continue;
            const Eigen::Vector2d pixel = solve.camera.pixel_from_camera(in_camera);
            if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < solve.camera.width &&
                  pixel.y() < solve.camera.height))
                continue;
            const PlanePixel seen = plane_pixel(point_m, eye_m, solve.camera.fx);
            if (seen.seen) widths.push_back(seen.across_m);
        }
    }
    return widths;
}

Eigen::Vector2d middle_of_rig(const Solve& solve, const Eigen::AlignedBox2d& otherwise) {
    Eigen::AlignedBox2d tags;
    for (const SolvedTag& tag : solve.rig) tags.extend(Eigen::Vector2d(tag.world_from_tag.translation().head<2>()));
    return tags.isEmpty() ? otherwise.center() : tags.center();
}

}  // namespace

PlanePixel plane_pixel(const Eigen::Vector3d& point_m, const Eigen::Vector3d& eye_m, double focal_px) {
    // Below this cosine a pixel spans a thousand times its width of the plane.
    constexpr double least_cosine = 1e-3;
    const Eigen::Vector3d way = eye_m - point_m;
    const double distance_m = way.norm();
    const double cosine = way.z() / distance_m;
    if (!(cosine > least_cosine)) return {};
    const double across_m = distance_m / focal_px;
    return {across_m, across_m / cosine, true};
}

PlaneGrid plan_plane_grid(const std::vector<RigidTransform>& cameras_from_world, const Solve& solve,
                          const LensMap& lens_map, double z_m, int most_texels) {
    const std::vector<SeenPoint> points = seen_points(cameras_from_world, solve.camera, lens_map, z_m);
    PlaneGrid grid;
    grid.z_m = z_m;
    if (points.empty()) return grid;
    std::vector<double> widths = widths_at_tags_m(cameras_from_world, solve, z_m);
    if (widths.empty()) {
        for (const SeenPoint& point : points) widths.push_back(point.pixel.across_m);
    }
    grid.texel_m = lower_quartile(std::move(widths));
    Eigen::AlignedBox2d well_seen;
    for (const SeenPoint& point : points) {
        if (point.pixel.along_m <= coarsest_pixel * grid.texel_m) well_seen.extend(point.place_m);
    }
    if (well_seen.isEmpty() || !(well_seen.sizes().minCoeff() > grid.texel_m)) return grid;
    const double widest_m = well_seen.sizes().maxCoeff();
    grid.texel_m = std::max(grid.texel_m, std::min(2 * grid.texel_m, widest_m / most_texels));
    const double most_m = grid.texel_m * most_texels;
    const Eigen::Vector2d middle = middle_of_rig(solve, well_seen);
    Eigen::Vector2d corner = well_seen.min();
    for (int axis = 0; axis < 2; ++axis) {
        const double span_m = well_seen.sizes()[axis];
        if (span_m > most_m)
            corner[axis] = std::clamp(middle[axis] - most_m / 2, corner[axis], well_seen.max()[axis] - most_m);
    }
    const auto texels = [&](double span_m) {
        const double steps = std::ceil(std::min(span_m, most_m) / (grid.texel_m * size_step) - 1e-9);
        return std::clamp(static_cast<int>(steps), 1, std::max(1, most_texels / size_step)) * size_step;
    };
    grid.columns = texels(well_seen.sizes().x());
    grid.rows = texels(well_seen.sizes().y());
    grid.rectangle_m = {corner, corner + grid.texel_m * Eigen::Vector2d(grid.columns, grid.rows)};
    return grid;
}

}  // namespace matchlight
