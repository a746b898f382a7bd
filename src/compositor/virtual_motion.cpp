// Follows points through the shutter's time.
#include "compositor/virtual_motion.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/virtual_layer.h"

namespace matchlight {

namespace {

/// Where a point is in the picture, by a lens without distortion; what lies behind the near plane is taken to it.
Eigen::Vector2d pinhole_pixel(const Eigen::Vector3d& point_camera_m, const Camera& camera) {
    const double z_m = std::max(point_camera_m.z(), near_plane_m);
    return {camera.fx * point_camera_m.x() / z_m, camera.fy * point_camera_m.y() / z_m};
}

MotionExtent within_picture(const MotionExtent& extent, const Camera& camera) {
    // A lens stretches ways by some percent, and between corners a way may be a little longer than theirs.
    constexpr double margin = 1.25;
    const double longest_px = std::hypot(camera.width, camera.height);
    return {.way_px = std::min(extent.way_px * margin, longest_px),
            .spread_px = std::min(extent.spread_px * margin, longest_px)};
}

/// The way of one point, `camera_point_m` of the time in frames.
MotionExtent extent_of(const std::function<Eigen::Vector3d(double)>& camera_point_m, double share,
                       const Camera& camera) {
    // Of a body that turns by less than half a turn: no way between leaves those to them by more than the margin.
    constexpr int steps = 8;
    const Eigen::Vector2d middle = pinhole_pixel(camera_point_m(0), camera);
    const Eigen::Vector2d opening = pinhole_pixel(camera_point_m(-share / 2), camera);
    const Eigen::Vector2d closing = pinhole_pixel(camera_point_m(share / 2), camera);
    MotionExtent extent{.way_px = (closing - opening).norm(), .spread_px = (closing - opening).norm() / 2};
    for (int i = 0; i <= steps; ++i) {
        const double time = share * (static_cast<double>(i) / steps - 0.5);
        extent.spread_px = std::max(extent.spread_px, (pinhole_pixel(camera_point_m(time), camera) - middle).norm());
    }
    return within_picture(extent, camera);
}

/// Of all vertices at the shutter's opening, middle and closing: a limb does not swing far within it.
MotionExtent deforming_extent(SceneObjects& objects, std::size_t object, const FrameShutter& shutter,
                              const Camera& camera) {
    const auto pixels_at = [&](double time) {
        const Eigen::Affine3d camera_from_model(shutter.camera_from_world(time).matrix() *
                                                objects.world_from_model(object, shutter.time(time)));
        std::vector<Eigen::Vector2d> pixels;
        for (const Eigen::Vector3d& position_m : objects.positions_m(object, shutter.time(time)))
            pixels.push_back(pinhole_pixel(camera_from_model * position_m, camera));
        return pixels;
    };
    const std::vector<Eigen::Vector2d> opening = pixels_at(-shutter.share() / 2), middle = pixels_at(0),
                                       closing = pixels_at(shutter.share() / 2);
    MotionExtent extent;
    for (std::size_t i = 0; i < middle.size(); ++i) {
        extent.extend({.way_px = (closing[i] - opening[i]).norm(),
                       .spread_px = std::max((opening[i] - middle[i]).norm(), (closing[i] - middle[i]).norm())});
    }
    return within_picture(extent, camera);
}

}  // namespace

void MotionExtent::extend(const MotionExtent& other) {
    way_px = std::max(way_px, other.way_px);
    spread_px = std::max(spread_px, other.spread_px);
}

MotionExtent object_motion_extent(const SurfaceRenderer& surfaces, SceneObjects& objects, const FrameShutter& shutter,
                                  const Camera& camera) {
    MotionExtent extent;
    for (std::size_t object = 0; object < surfaces.object_count(); ++object) {
        if (objects.deforms(object)) {
            extent.extend(deforming_extent(objects, object, shutter, camera));
            continue;
        }
        const Eigen::AlignedBox3d box_m = surfaces.model_bounds_m(object);
        if (box_m.isEmpty()) continue;
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector4d corner = box_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)).homogeneous();
            extent.extend(extent_of(
                [&](double time) -> Eigen::Vector3d {
                    const Eigen::Vector4d world = objects.world_from_model(object, shutter.time(time)) * corner;
                    return shutter.camera_from_world(time) * world.head<3>();
                },
                shutter.share(), camera));
        }
    }
    return extent;
}

MotionExtent surface_motion_extent(double z_m, const FrameShutter& shutter, const LensMap& lens_map,
                                   const Camera& camera) {
    const RigidTransform world_from_camera = shutter.camera_from_world().inverse();
    const Eigen::Vector3d eye_m = world_from_camera.translation();
    // Ways on a plane change evenly over the picture.
    constexpr int steps = 8;
    MotionExtent extent;
    for (int i = 0; i <= steps; ++i) {
        for (int j = 0; j <= steps; ++j) {
            const double x = (camera.width - 1.0) * i / steps, y = (camera.height - 1.0) * j / steps;
            const Eigen::Vector3d direction = world_from_camera.linear() * lens_map.normalized(x, y).homogeneous();
            const double distance = (z_m - eye_m.z()) / direction.z();
            if (!(distance > 0) || !std::isfinite(distance)) continue;
            const Eigen::Vector3d point_m = eye_m + distance * direction;
            extent.extend(extent_of([&](double time) { return shutter.camera_from_world(time) * point_m; },
                                    shutter.share(), camera));
        }
    }
    return extent;
}

}  // namespace matchlight
