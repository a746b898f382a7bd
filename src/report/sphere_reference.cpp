// Rays through pixels, places in pixels, and hemispheres.
#include "report/sphere_reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.h"
#include "core/transfer.h"

namespace matchlight {
namespace {

/// The middle of one of `side` equal parts of [−½, ½].
double place(int index, int side) {
    return (index + 0.5) / side - 0.5;
}

std::int64_t id_through(const SphereCaster& spheres, const ReferenceView& view, double x_px, double y_px) {
    const auto hit = spheres.nearest(view.ray_through(x_px, y_px));
    return hit ? sphere_id(spheres, *hit) : no_sphere;
}

}  // namespace

SphereRay ReferenceView::ray_through(double x_px, double y_px) const {
    const RigidTransform world_from_camera = camera_from_world.inverse();
    SphereRay ray;
    ray.origin_m = world_from_camera.translation();
    ray.direction =
        world_from_camera.linear() * Eigen::Vector3d((x_px + pinhole.origin_x - pinhole.cx) / pinhole.fx,
                                                     (y_px + pinhole.origin_y - pinhole.cy) / pinhole.fy, 1);
    ray.least = pinhole.near_m;
    return ray;
}

SpherePoint point_of(const SphereCaster& spheres, const SphereRay& ray, const SphereHit& hit) {
    const Eigen::Vector3d position_m = ray.origin_m + hit.distance * ray.direction;
    return {hit, position_m, spheres.normal_at(hit, position_m), -ray.direction.normalized()};
}

Eigen::Vector3d color_of(const SphereSet& set, std::uint32_t sphere) {
    if (set.colors.empty()) return Eigen::Vector3f(set.color.data()).cast<double>();
    const auto& code = set.colors[sphere];
    return {linear_from_srgb_code(code[0] / 255.0), linear_from_srgb_code(code[1] / 255.0),
            linear_from_srgb_code(code[2] / 255.0)};
}

double opacity_of(const SphereSet& set, std::uint32_t sphere) {
    return static_cast<double>(set.opacities.empty() ? set.opacity : set.opacities[sphere]);
}

std::int64_t sphere_id(const SphereCaster& spheres, const SphereHit& hit) {
    std::int64_t before = 0;
    for (std::uint32_t set = 0; set < hit.set; ++set) before += static_cast<std::int64_t>(spheres.set(set).size());
    return before + hit.sphere;
}

SpherePicture reference_picture(const SphereCaster& spheres, const ReferenceView& view) {
    SpherePicture picture{Image<std::int64_t>(view.width(), view.height(), 1, no_sphere),
                          Image<double>(view.width(), view.height(), 1, std::numeric_limits<double>::infinity())};
    parallel_for(view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            const auto hit = spheres.nearest(view.ray_through(x, y));
            if (!hit) continue;
            picture.ids.at(x, y) = sphere_id(spheres, *hit);
            picture.depth_m.at(x, y) = hit->distance;
        }
    });
    return picture;
}

std::vector<SphereShare> reference_coverage(const SphereCaster& spheres, const ReferenceView& view, int x, int y,
                                            int side) {
    assert(side > 0);
    std::vector<std::int64_t> ids;
    for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
            ids.push_back(id_through(spheres, view, x + place(column, side), y + place(row, side)));
        }
    }
    std::ranges::sort(ids);
    std::vector<SphereShare> shares;
    for (const std::int64_t id : ids) {
        if (shares.empty() || shares.back().id != id) shares.push_back({id, 0});
        shares.back().share += 1.0 / (side * side);
    }
    return shares;
}

bool is_sphere_edge(const SphereCaster& spheres, const ReferenceView& view, int x, int y, const EdgeTest& test) {
    assert(test.side > 1);
    const int side = test.side;
    const double spread = (1 + 2 * test.margin_px) * side / (side - 1);
    const std::int64_t middle = id_through(spheres, view, x, y);
    for (int i = 0; i < side * side; ++i) {
        const double right = spread * place(i % side, side), down = spread * place(i / side, side);
        if (id_through(spheres, view, x + right, y + down) != middle) return true;
    }
    return false;
}

ReferenceView finer(const ReferenceView& view, int times) {
    ReferenceView fine = view;
    PinholeView& pinhole = fine.pinhole;
    pinhole.fx *= times;
    pinhole.fy *= times;
    pinhole.cx = (pinhole.cx + 0.5) * times - 0.5;
    pinhole.cy = (pinhole.cy + 0.5) * times - 0.5;
    pinhole.origin_x *= times;
    pinhole.origin_y *= times;
    pinhole.width *= times;
    pinhole.height *= times;
    return fine;
}

ReferenceView cropped(const ReferenceView& view, const Region& region) {
    ReferenceView part = view;
    part.pinhole.cx -= region.x;
    part.pinhole.cy -= region.y;
    part.pinhole.width = region.width;
    part.pinhole.height = region.height;
    return part;
}

ImageF reference_opaque(const SphereCaster& spheres, const ReferenceView& view, int side, const SphereLight& light) {
    ImageF picture(view.width(), view.height(), 4);
    parallel_for(view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            Eigen::Vector4d sum = Eigen::Vector4d::Zero();
            for (int i = 0; i < side * side; ++i) {
                const SphereRay ray = view.ray_through(x + place(i % side, side), y + place(i / side, side));
                const auto hit = spheres.nearest(ray);
                if (!hit) continue;
                sum.head<3>() += light(point_of(spheres, ray, *hit));
                sum[3] += 1;
            }
            for (int c = 0; c < 4; ++c) picture.at(x, y, c) = static_cast<float>(sum[c] / (side * side));
        }
    });
    return picture;
}

Image<double> reference_halos(const SphereCaster& spheres, const ReferenceView& view, const SphereHalo& halo) {
    const SpherePicture seen = reference_picture(spheres, view);
    const double radius_px = view.pinhole.fx * std::tan(halo.width_deg * std::numbers::pi / 180);
    const int reach = static_cast<int>(radius_px);
    Image<double> left(view.width(), view.height(), 1, 1);
    parallel_for(view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            const double z_m = seen.depth_m.at(x, y);
            if (!std::isfinite(z_m)) continue;
            double most = 0;
            for (int j = std::max(y - reach, 0); j <= std::min(y + reach, view.height() - 1); ++j) {
                for (int i = std::max(x - reach, 0); i <= std::min(x + reach, view.width() - 1); ++i) {
                    const double behind_m = z_m - seen.depth_m.at(i, j);
                    const double near_share = 1 - std::hypot(i - x, j - y) / radius_px;
                    most = std::max(most, near_share * std::clamp(behind_m / halo.depth_m, 0.0, 1.0));
                }
            }
            left.at(x, y) = 1 - halo.strength * most;
        }
    });
    return left;
}

std::vector<TransparentLayer> reference_layers(const SphereCaster& spheres, const SphereRay& ray,
                                               const SphereLight& light) {
    std::vector<SphereHit> hits;
    spheres.all(ray, SphereCaster::Surfaces::first, hits);
    std::vector<TransparentLayer> layers;
    layers.reserve(hits.size());
    for (const SphereHit& hit : hits) {
        layers.push_back(
            {light(point_of(spheres, ray, hit)), opacity_of(spheres.set(hit.set), hit.sphere), hit.distance});
    }
    return layers;
}

Eigen::Vector3d reference_irradiance(const SphereCaster& spheres, const SpherePoint& point, int side,
                                     const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& radiance) {
    const Eigen::Vector3d& up = point.normal;
    const Eigen::Vector3d right = up.unitOrthogonal(), forward = up.cross(right);
    // A sphere that coincides with the point's own is met at the point itself, give or take its rounding.
    const double least = 1e-9 * spheres.radius_m(point.hit);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int ring = 0; ring < side; ++ring) {
        // Equal shares of the cosine: the disc below the hemisphere in rings of one area (Malley's method).
        const double radius = std::sqrt((ring + 0.5) / side);
        const double height = std::sqrt(1 - radius * radius);
        for (int sector = 0; sector < side; ++sector) {
            // Rings are turned against each other by the golden angle, so that no two share a meridian.
            constexpr double golden = std::numbers::phi - 1;
            const double azimuth = 2 * std::numbers::pi * ((sector + 0.5) / side + golden * ring);
            const Eigen::Vector3d direction =
                radius * (std::cos(azimuth) * right + std::sin(azimuth) * forward) + height * up;
            const SphereRay ray{.origin_m = point.position_m, .direction = direction, .least = least};
            if (!spheres.meets(ray, &point.hit)) sum += radiance(direction);
        }
    }
    return std::numbers::pi / (static_cast<double>(side) * side) * sum;
}

double reference_open_share(const SphereCaster& spheres, const SpherePoint& point, int side) {
    const auto even = [](const Eigen::Vector3d&) -> Eigen::Vector3d { return Eigen::Vector3d::Ones(); };
    return reference_irradiance(spheres, point, side, even).x() / std::numbers::pi;
}

}  // namespace matchlight
