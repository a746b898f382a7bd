// Fisheye pictures of a known probe; the projections' inverses are written down here anew.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include <Eigen/Geometry>

#include "lighting/fisheye_lens.h"
#include "lighting/probe.h"

namespace matchlight::test {

struct FisheyeShot {
    FisheyeProjection projection = FisheyeProjection::equidistant;
    int width = 460, height = 460;
    PixelCircle circle{{229.5, 229.5}, 220};
    double fov_deg = 200;
    Eigen::Matrix3d world_from_camera = Eigen::Matrix3d::Identity();  // x right, y down, z forward
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();
    double frame_light = 0;  // around the circle
};

/// The camera of a pair that looks along world +y, or backwards along −y, upright.
inline Eigen::Matrix3d front_camera() {
    Eigen::Matrix3d axes;
    axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    return axes;
}
inline Eigen::Matrix3d back_camera() {
    return Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix() * front_camera();
}

/// θ for a distance from the centre in focal lengths.
inline double angle_of_radius(FisheyeProjection projection, double radius) {
    switch (projection) {
        case FisheyeProjection::equisolid:
            return 2 * std::asin(std::min(1.0, radius / 2));
        case FisheyeProjection::orthographic:
            return std::asin(std::min(1.0, radius));
        case FisheyeProjection::stereographic:
            return 2 * std::atan(radius / 2);
        default:
            return radius;
    }
}

using Light = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Pixels are means over their area.
inline ImageF fisheye_picture(const Light& light, const FisheyeShot& shot) {
    const double half = shot.fov_deg / 2 * std::numbers::pi / 180;
    const double rim = shot.projection == FisheyeProjection::equisolid       ? 2 * std::sin(half / 2)
                       : shot.projection == FisheyeProjection::orthographic  ? std::sin(half)
                       : shot.projection == FisheyeProjection::stereographic ? 2 * std::tan(half / 2)
                                                                             : half;
    ImageF picture(shot.width, shot.height, 3);
    constexpr int steps = 4;
    for (int y = 0; y < shot.height; ++y) {
        for (int x = 0; x < shot.width; ++x) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int i = 0; i < steps * steps; ++i) {
                const Eigen::Vector2d from_centre(x + (i % steps + 0.5) / steps - 0.5 - shot.circle.centre_px.x(),
                                                  y + (i / steps + 0.5) / steps - 0.5 - shot.circle.centre_px.y());
                const double distance = from_centre.norm();
                if (distance > shot.circle.radius_px) {
                    sum += Eigen::Vector3d::Constant(shot.frame_light);
                    continue;
                }
                const double angle = angle_of_radius(shot.projection, distance / shot.circle.radius_px * rim);
                const Eigen::Vector2d along = from_centre / std::max(distance, 1e-12) * std::sin(angle);
                sum += light(shot.world_from_camera * Eigen::Vector3d(along.x(), along.y(), std::cos(angle)));
            }
            for (int c = 0; c < 3; ++c) {
                picture.at(x, y, c) = static_cast<float>(shot.gain[c] * sum[c] / (steps * steps));
            }
        }
    }
    return picture;
}

/// A room: a smooth sky with stripes of detail everywhere, and lamps of 2° across at the given directions.
inline Light striped_room(const std::vector<Eigen::Vector3d>& lamps) {
    return [lamps](const Eigen::Vector3d& d) {
        Eigen::Vector3d light(1 + 0.5 * d.x() + 0.3 * d.y() * d.z(), 0.8 + 0.4 * d.z() + 0.2 * d.x() * d.y(),
                              0.6 - 0.3 * d.y() + 0.3 * d.z() * d.z());
        light *=
            1 + 0.4 * std::sin(14 * d.x() + 3 * d.z()) * std::cos(11 * d.z()) + 0.2 * std::sin(9 * d.y() + 17 * d.x());
        for (const Eigen::Vector3d& lamp : lamps) {
            // Smooth, so that a picture's pixels can tell its middle.
            const double width = 0.6 * std::numbers::pi / 180;
            light += Eigen::Vector3d(400, 350, 250) * std::exp(-0.5 * (d - lamp).squaredNorm() / (width * width));
        }
        return light;
    };
}

}  // namespace matchlight::test
