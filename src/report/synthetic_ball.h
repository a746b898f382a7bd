// Photographs of a mirror ball in a known sky, by casting rays: what building a probe is held against.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "core/transforms.h"
#include "lighting/ball_view.h"
#include "lighting/mirror_ball.h"

namespace matchlight {

/// Radiance that arrives from a direction, infinitely far away.
using Sky = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Radiance that arrives at a place from a direction.
using Surroundings = std::function<Eigen::Vector3d(const Eigen::Vector3d& place_m, const Eigen::Vector3d& towards)>;

struct BallShot {
    Camera camera;
    MirrorBall ball;  // world
    RigidTransform camera_from_world;
    double reflectance = 1;  // head on
    double blob = 0;         // cosine: the photographer, black, from his direction out to this
    /// What stands close behind the ball, if anything: at its rim a mirror shows what lies far behind it.
    std::optional<Eigen::Vector3d> backdrop;
    Surroundings near;  // what the ball reflects, where that is not the sky
};

inline Camera long_lens(int width, int height, double focal_px) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = focal_px;
    camera.cx = (width - 1) / 2.0 + 7.3;
    camera.cy = (height - 1) / 2.0 - 4.6;
    camera.distortion = {-0.09, 0.03, 5e-4, -3e-4, 0};
    return camera;
}

/// A camera at `eye_m` that sees the ball near the middle of its picture.
inline RigidTransform looking_at(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& target_m) {
    return camera_looking_along(eye_m, (target_m - eye_m).normalized());
}

/// Every pixel is the mean of `side` × `side` rays.
inline BallView photographed(const BallShot& shot, const Sky& sky, int side = 4) {
    BallView view;
    view.name = "synthetic";
    view.camera = shot.camera;
    view.radiance = ImageF(shot.camera.width, shot.camera.height, 3);
    BallView posed;
    posed.camera = shot.camera;
    posed.camera_from_world = shot.camera_from_world;
    const Eigen::Vector3d eye = posed.eye_m();
    const Eigen::Vector3d towards_eye = (eye - shot.ball.centre_m).normalized();
    parallel_for(shot.camera.height, [&](int y) {
        for (int x = 0; x < shot.camera.width; ++x) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            // The backdrop needs no more than one ray a pixel.
            const bool plain = shot.backdrop && miss_ratio(shot.ball, eye, posed.ray(Eigen::Vector2d(x, y))) > 1.3;
            const int across = plain ? 1 : side;
            for (int k = 0; k < across * across; ++k) {
                const int column = k % across, row = k / across;
                const double dx = (column + 0.5) / across - 0.5, dy = (row + 0.5) / across - 0.5;
                const Eigen::Vector3d ray = posed.ray({x + dx, y + dy});
                const auto hit = hit_ball(shot.ball, eye, ray);
                if (!hit) {
                    sum += shot.backdrop ? *shot.backdrop : sky(ray);
                } else if (shot.blob <= 0 || hit->reflected.dot(towards_eye) < shot.blob) {
                    sum += fresnel_reflectance(shot.reflectance, hit->cosine) *
                           (shot.near ? shot.near(hit->point_m, hit->reflected) : sky(hit->reflected));
                }
            }
            for (int c = 0; c < 3; ++c) view.radiance.at(x, y, c) = static_cast<float>(sum[c] / (across * across));
        }
    });
    return view;
}

/// A Lambertian ball in the mirror's place, posed: `irradiance` by its normal; before the backdrop or black. A ray a
/// pixel.
inline BallView photographed_matte(const BallShot& shot, const Eigen::Vector3d& albedo, const Sky& irradiance) {
    BallView view;
    view.name = "matte";
    view.camera = shot.camera;
    view.camera_from_world = shot.camera_from_world;
    view.radiance = ImageF(shot.camera.width, shot.camera.height, 3);
    const Eigen::Vector3d eye = view.eye_m();
    parallel_for(shot.camera.height, [&](int y) {
        for (int x = 0; x < shot.camera.width; ++x) {
            const auto hit = hit_ball(shot.ball, eye, view.ray(Eigen::Vector2d(x, y)));
            Eigen::Vector3d light = shot.backdrop.value_or(Eigen::Vector3d::Zero());
            if (hit) light = albedo.cwiseProduct(irradiance(hit->normal)) / std::numbers::pi;
            for (int c = 0; c < 3; ++c) view.radiance.at(x, y, c) = static_cast<float>(light[c]);
        }
    });
    return view;
}

/// A room: bright above, dark below, a window, a red wall, and a lamp at `lamp` of 3° radius.
inline Sky room_with_lamp(const Eigen::Vector3d& lamp, double lamp_radiance) {
    return [=](const Eigen::Vector3d& d) -> Eigen::Vector3d {
        if (d.dot(lamp) > std::cos(3 * std::numbers::pi / 180)) return Eigen::Vector3d::Constant(lamp_radiance);
        const double azimuth = std::atan2(d.y(), d.x());
        if (d.z() > 0 && d.z() < 0.5 && azimuth > 0.3 && azimuth < 1.2) return {3, 4, 6};
        if (d.z() > -0.1 && d.z() < 0.3 && azimuth < -1.5 && azimuth > -2.3) return {2, 0.4, 0.3};
        const Eigen::Vector3d walls(1 + 0.5 * d.x() + 0.3 * d.y() * d.z(), 0.8 + 0.4 * d.z() + 0.2 * d.x() * d.y(),
                                    0.6 - 0.3 * d.y() + 0.3 * d.z() * d.z());
        return walls * (d.z() > 0 ? 0.6 : 0.2);
    };
}

}  // namespace matchlight
