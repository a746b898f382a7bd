// Perspective keeps convex bodies convex: the bounds of the clipped edges' ends are the bounds of the body.
#include "compositor/reach.h"

#include <algorithm>
#include <cmath>

#include "render/virtual_layer.h"

namespace matchlight {

Eigen::AlignedBox2d normalized_bounds(const std::vector<Eigen::Vector3d>& corners_world_m,
                                      const std::vector<std::array<int, 2>>& edges,
                                      const RigidTransform& camera_from_world, const LensMap& lens_map, double beyond) {
    Eigen::AlignedBox2d bounds;
    for (const auto& [from, to] : edges) {
        Eigen::Vector3d a = camera_from_world * corners_world_m[from];
        Eigen::Vector3d b = camera_from_world * corners_world_m[to];
        if (a.z() < near_plane_m && b.z() < near_plane_m) continue;
        if (a.z() > b.z()) std::swap(a, b);
        if (a.z() < near_plane_m) a += (b - a) * ((near_plane_m - a.z()) / (b.z() - a.z()));
        bounds.extend(Eigen::Vector2d(a.head<2>() / a.z()));
        bounds.extend(Eigen::Vector2d(b.head<2>() / b.z()));
    }
    const Eigen::AlignedBox2d& frame = lens_map.normalized_bounds;
    if (bounds.isEmpty() || frame.isEmpty()) return {};
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(beyond);
    return bounds.intersection(Eigen::AlignedBox2d(frame.min() - margin, frame.max() + margin));
}

Eigen::AlignedBox2d normalized_bounds_of_box(const Eigen::AlignedBox3d& box_world_m,
                                             const RigidTransform& camera_from_world, const LensMap& lens_map,
                                             double beyond) {
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
        corners.push_back(box_world_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
    }
    // Corner numbers are bit patterns of x, y, z: an edge joins two that differ in one bit.
    std::vector<std::array<int, 2>> edges;
    for (int i = 0; i < 8; ++i) {
        for (int bit = 1; bit < 8; bit <<= 1) {
            if ((i & bit) == 0) edges.push_back({i, i | bit});
        }
    }
    return normalized_bounds(corners, edges, camera_from_world, lens_map, beyond);
}

Eigen::AlignedBox2d normalized_bounds_of_rectangle(const Eigen::AlignedBox2d& rectangle_m, double z_m,
                                                   const RigidTransform& camera_from_world, const LensMap& lens_map) {
    const Eigen::Vector2d& low = rectangle_m.min();
    const Eigen::Vector2d& high = rectangle_m.max();
    return normalized_bounds(
        {{low.x(), low.y(), z_m}, {high.x(), low.y(), z_m}, {high.x(), high.y(), z_m}, {low.x(), high.y(), z_m}},
        {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, camera_from_world, lens_map);
}

Region plate_region(const Eigen::AlignedBox2d& bounds, const Camera& camera, const LensMap& lens_map, int margin_px) {
    if (bounds.isEmpty()) return {};
    const Eigen::Array2d focal_px(camera.fx, camera.fy);
    // What lies beyond may be nearer in the picture than straight on, by as much as lenses magnify less at their rim.
    const double nearer = camera.has_distortion() ? 0.8 : 1;
    const auto pixel_of = [&](const Eigen::Vector2d& normalized) -> Eigen::Vector2d {
        const Eigen::Vector2d inside =
            normalized.cwiseMax(lens_map.normalized_bounds.min()).cwiseMin(lens_map.normalized_bounds.max());
        return camera.pixel_from_normalized(inside) + (nearer * focal_px * (normalized - inside).array()).matrix();
    };
    // A lens bends the rectangle's sides outwards or inwards: follow them, every side in steps.
    constexpr int steps = 32;
    Eigen::AlignedBox2d pixels;
    for (int i = 0; i <= steps; ++i) {
        for (int j = 0; j <= steps; ++j) {
            const Eigen::Vector2d t(static_cast<double>(i) / steps, static_cast<double>(j) / steps);
            const Eigen::Vector2d pixel = pixel_of(bounds.min() + t.cwiseProduct(bounds.max() - bounds.min()));
            if (pixel.allFinite()) pixels.extend(pixel);
        }
    }
    if (pixels.isEmpty()) return {};
    // The frame is cut in floating point first: a far-off coordinate need not fit an int.
    const Eigen::AlignedBox2d frame(Eigen::Vector2d(-1 - margin_px, -1 - margin_px),
                                    Eigen::Vector2d(camera.width + margin_px, camera.height + margin_px));
    pixels = pixels.intersection(frame);
    if (pixels.isEmpty()) return {};
    const int left = static_cast<int>(std::floor(pixels.min().x()));
    const int top = static_cast<int>(std::floor(pixels.min().y()));
    const Region region{left, top, static_cast<int>(std::ceil(pixels.max().x())) - left + 1,
                        static_cast<int>(std::ceil(pixels.max().y())) - top + 1};
    return region.grown(margin_px).intersected({0, 0, camera.width, camera.height});
}

std::int64_t Reach::pixels() const {
    std::int64_t sum = 0;
    for (const Region& run : runs) sum += static_cast<std::int64_t>(run.width) * run.height;
    return sum;
}

bool Reach::has_tile(int column, int row) const {
    return std::any_of(runs.begin(), runs.end(),
                       [&](const Region& run) { return run.contains(column * tile_px, row * tile_px); });
}

namespace {

Region tile_at(int column, int row, const Camera& camera) {
    return Region{column * Reach::tile_px, row * Reach::tile_px, Reach::tile_px, Reach::tile_px}.intersected(
        {0, 0, camera.width, camera.height});
}

/// The surface that a tile sees; the whole plane where one of its corners sees none (a horizon crosses the tile, or the
/// lens model does not reach it), empty where none of them does.
Eigen::AlignedBox2d surface_seen(const Region& tile, double surface_z_m, const RigidTransform& world_from_camera,
                                 const LensMap& lens_map) {
    const Eigen::Vector3d eye = world_from_camera.translation();
    Eigen::AlignedBox2d seen;
    int missing = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = tile.x + (corner & 1) * tile.width;
        const int y = tile.y + (corner >> 1) * tile.height;
        const Eigen::Vector3d direction = world_from_camera.linear() * lens_map.normalized(x, y).homogeneous();
        const double distance = (surface_z_m - eye.z()) / direction.z();
        if (!(distance > 0) || !std::isfinite(distance)) {
            ++missing;
            continue;
        }
        seen.extend(Eigen::Vector2d((eye + distance * direction).head<2>()));
    }
    if (missing == 4) return {};
    if (missing > 0) {
        constexpr double everywhere_m = 1e9;
        return {Eigen::Vector2d::Constant(-everywhere_m), Eigen::Vector2d::Constant(everywhere_m)};
    }
    // A lens bends the tile's sides by less than an eighth of its size.
    const Eigen::Vector2d margin = seen.sizes() / 8;
    return {seen.min() - margin, seen.max() + margin};
}

}  // namespace

bool sees_shadow(const Region& part, const ShadowReach& shadow, const RigidTransform& world_from_camera,
                 const LensMap& lens_map, const Camera& camera) {
    if (!shadow.in) return false;
    Region around = shadow.spread_px ? part.grown(shadow.spread_px(part)) : part;
    if (!shadow.beyond_frame) around = around.intersected({0, 0, camera.width, camera.height});
    const Eigen::AlignedBox2d seen = surface_seen(around, shadow.surface_z_m, world_from_camera, lens_map);
    return !seen.isEmpty() && shadow.in(seen);
}

std::vector<Region> frame_tiles(const Camera& camera) {
    std::vector<Region> tiles;
    for (int y = 0; y < camera.height; y += Reach::tile_px) {
        for (int x = 0; x < camera.width; x += Reach::tile_px)
            tiles.push_back(tile_at(x / Reach::tile_px, y / Reach::tile_px, camera));
    }
    return tiles;
}

Reach tiles_of(const Camera& camera, const std::function<bool(int column, int row)>& wanted) {
    const int columns = (camera.width + Reach::tile_px - 1) / Reach::tile_px;
    const int rows = (camera.height + Reach::tile_px - 1) / Reach::tile_px;
    Reach reach;
    for (int row = 0; row < rows; ++row) {
        Region run;
        // One column past the last ends the run.
        for (int column = 0; column <= columns; ++column) {
            if (column < columns && wanted(column, row)) {
                run = run.united(tile_at(column, row, camera));
            } else if (!run.empty()) {
                reach.runs.push_back(run);
                reach.bounds = reach.bounds.united(run);
                run = {};
            }
        }
    }
    return reach;
}

bool sees_mirrored(const Region& part, const MirrorReach& mirror, const RigidTransform& world_from_camera,
                   const LensMap& lens_map) {
    const Eigen::Vector3d eye = world_from_camera.translation();
    if (eye.z() <= mirror.surface_z_m) return false;
    const Region around = part.grown(1);  // rays go from all of a pixel's area
    struct Seen {
        Eigen::Vector3d at_m, mirrored;
    };
    const auto seen_at = [&](double x, double y) -> std::optional<Seen> {
        Eigen::Vector3d direction = world_from_camera.linear() * lens_map.normalized(x, y).homogeneous();
        const double distance = (mirror.surface_z_m - eye.z()) / direction.z();
        if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
        const Eigen::Vector3d at_m = eye + distance * direction;
        direction.normalize();
        return Seen{at_m, {direction.x(), direction.y(), -direction.z()}};
    };
    // The middle of the part and its corners.
    const auto middle = seen_at(around.x + 0.5 * around.width, around.y + 0.5 * around.height);
    std::vector<Seen> corners;
    for (int corner = 0; corner < 4; ++corner) {
        const auto seen = seen_at(around.x + (corner & 1) * around.width, around.y + (corner >> 1) * around.height);
        if (seen) corners.push_back(*seen);
    }
    if (corners.empty() && !middle) return false;
    if (corners.size() < 4 || !middle) return true;  // the horizon crosses it, or the lens model ends in it
    const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return std::atan2(a.cross(b).norm(), a.dot(b));
    };
    double radius_m = 0, spread = 0;
    for (const Seen& corner : corners) {
        radius_m = std::max(radius_m, (corner.at_m - middle->at_m).norm());
        spread = std::max(spread, angle(corner.mirrored, middle->mirrored));
    }
    // A lens bends the part's sides by less than an eighth of its size; what grazes the surface is raised off it.
    constexpr double bend = 1.125, raised_rad = 2e-3;
    const Eigen::Vector3d to_objects_m = mirror.objects_m.center() - middle->at_m;
    const double reach_m = mirror.objects_m.diagonal().norm() / 2 + bend * radius_m;
    const double distance_m = to_objects_m.norm();
    if (distance_m <= reach_m) return true;
    return angle(to_objects_m, middle->mirrored) <=
           std::asin(reach_m / distance_m) + bend * spread + mirror.lobe_rad + raised_rad;
}

Reach make_reach(const ReachSources& sources, const RigidTransform& camera_from_world, const LensMap& lens_map,
                 const Camera& camera) {
    const RigidTransform world_from_camera = camera_from_world.inverse();
    return tiles_of(camera, [&](int column, int row) {
        const Region tile = tile_at(column, row, camera);
        for (const Region& region : sources.object_regions) {
            if (!tile.intersected(region).empty()) return true;
        }
        if (sources.mirror && sees_mirrored(tile, *sources.mirror, world_from_camera, lens_map)) return true;
        return sees_shadow(tile, sources.shadow, world_from_camera, lens_map, camera);
    });
}

}  // namespace matchlight
