// Photographs of a mirror ball at their worst: tiny, huge, and with a sun in the room.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "lighting/ball_outline.h"
#include "lighting/ball_probe.h"
#include "lighting/diffuse_ball.h"
#include "lighting/latlong_grid.h"
#include "report/stability_cases.h"
#include "report/synthetic_ball.h"

namespace matchlight {
namespace {

const Eigen::Vector3d lamp = Eigen::Vector3d(0.3, 0.5, 0.8).normalized();
constexpr double lamp_radius = 3 * std::numbers::pi / 180;

/// A ball of 35 mm, `radius_px` pixels in radius, 0.7 m away before a plain backdrop; a small one in a larger frame.
BallShot shot_of(double radius_px) {
    BallShot shot;
    shot.ball = {{0, 0, 0.035}, 0.035};
    const auto side = static_cast<int>(std::max(320.0, 2.6 * radius_px));
    shot.camera = long_lens(side, side, radius_px * 0.7 / 0.035);
    shot.camera_from_world = looking_at({0.35, -0.55, 0.27}, shot.ball.centre_m);
    shot.reflectance = 0.7;
    shot.backdrop = Eigen::Vector3d(0.35, 0.33, 0.3);
    return shot;
}

/// How far the outline that is found lies from the true one, pixels: centre and radius, the worse.
double outline_error_px(double radius_px, int rays, bool by_hand) {
    const BallShot shot = shot_of(radius_px);
    const BallView view = photographed(shot, room_with_lamp(lamp, 500), rays);
    const Eigen::Vector3d centre = shot.camera_from_world * shot.ball.centre_m;
    std::optional<OutlineCircle> circle;
    if (by_hand) circle = {shot.camera.pixel_from_camera(centre) + Eigen::Vector2d(0.7, -0.5), 1.05 * radius_px};
    const BallOutline found = find_ball(view.radiance, shot.camera, circle, "synthetic ball");
    const double half_angle = std::asin(shot.ball.radius_m / centre.norm());
    const double aside =
        (shot.camera.pixel_from_camera(found.axis) - shot.camera.pixel_from_camera(centre.normalized())).norm();
    return std::max(aside, std::abs(found.half_angle - half_angle) * shot.camera.fx);
}

/// Energy of the lamp in the probe over the truth.
StabilityOutcome lamp_energy(double radius_px, int rays, double radiance, int height) {
    const BallShot shot = shot_of(radius_px);
    BallView view = photographed(shot, room_with_lamp(lamp, radiance), rays);
    view.camera_from_world = shot.camera_from_world;
    const std::vector<BallView> views = {view};
    const BallScene scene{views, shot.ball, Eigen::Vector3d::Constant(shot.reflectance), std::nullopt, nullptr};
    BallProbeOptions options;
    options.height = height;
    const BallProbe built = probe_from_balls(scene, options);
    const LatlongGrid grid(built.radiance.width(), built.radiance.height());
    // Its pixels, and a few of the ball's and of the map's around them.
    const double reach = lamp_radius + 6 / radius_px + 3 * std::numbers::pi / grid.height();
    double energy = 0;
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            if (latlong_direction(x, y, grid.width(), grid.height()).dot(lamp) < std::cos(reach)) continue;
            energy += grid.solid_angle(y) * static_cast<double>(built.radiance.at(x, y, 1));
        }
    }
    return {energy / (radiance * 2 * std::numbers::pi * (1 - std::cos(lamp_radius)))};
}

/// A lamp that photographs held at `limit` alone, its energy solved by a matte ball's shading, over the truth.
StabilityOutcome clipped_lamp_energy(double radiance, float limit) {
    constexpr int height = 64;
    const auto is_lamp = [](int x, int y) {
        return latlong_direction(x, y, 2 * height, height).dot(lamp) > std::cos(2 * lamp_radius);
    };
    const Sky walls = room_with_lamp(lamp, 1);
    Probe truth{ImageF(2 * height, height, 3)};
    BallProbe probe{truth.latlong, ImageF(2 * height, height, 1), {}, ImageF(2 * height, height, 1)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            const Eigen::Vector3d light = walls(latlong_direction(x, y, 2 * height, height));
            for (int c = 0; c < 3; ++c) {
                truth.latlong.at(x, y, c) = static_cast<float>(is_lamp(x, y) ? radiance : light[c]);
                probe.radiance.at(x, y, c) = is_lamp(x, y) ? limit : truth.latlong.at(x, y, c);
            }
            probe.clipped.at(x, y) = is_lamp(x, y) ? 1.0F : 0.0F;
        }
    }
    const BallShot shot = shot_of(40);
    DiffuseBall matte{photographed_matte(shot, Eigen::Vector3d::Constant(0.5),
                                         [&](const Eigen::Vector3d& normal) { return irradiance(truth, normal); }),
                      std::nullopt};
    const Eigen::Vector3d centre = shot.camera_from_world * shot.ball.centre_m;
    matte.view.outline.axis = centre.normalized();
    matte.view.outline.half_angle = std::asin(shot.ball.radius_m / centre.norm());
    const auto lights = solve_clipped_lights(probe, matte);
    return {lights.empty() ? 0 : lights.front().gain.y() * static_cast<double>(limit) / radiance};
}

}  // namespace

std::vector<StabilityCase> ball_cases(bool quick) {
    std::vector<StabilityCase> cases = {
        {"mirror ball",
         "of 20 pixels, its circle by hand",
         "outline off by, px",
         {0, 0.4},
         {},
         [] { return StabilityOutcome{outline_error_px(10, 4, true)}; }},
        {"mirror ball",
         "of 20 pixels, a lamp of 20,000 times the walls",
         "its energy over the truth",
         {0.85, 1.15},
         {},
         [] { return lamp_energy(10, 12, 1e4, 0); }},
        {"mirror ball",
         "of 300 pixels, a sun a million times the walls",
         "its energy over the truth",
         {0.98, 1.02},
         {},
         [] { return lamp_energy(150, 3, 1e6, 128); }},
    };
    for (const double radiance : {12.0, 1e6, 1e12}) {
        cases.push_back({"matte ball",
                         fmt::format("a lamp of {:g} times the walls that photographs held at 10", radiance),
                         "its energy over the truth",
                         {0.95, 1.05},
                         {},
                         [radiance] { return clipped_lamp_energy(radiance, 10); }});
    }
    if (quick) return cases;
    cases.push_back({"mirror ball", "of 3000 pixels", "outline off by, px", {0, 0.6}, {}, [] {
                         return StabilityOutcome{outline_error_px(1500, 1, false)};
                     }});
    cases.push_back(
        {"mirror ball", "of 3000 pixels in 256 rows", "its lamp's energy over the truth", {0.99, 1.01}, {}, [] {
             return lamp_energy(1500, 1, 1e4, 256);
         }});
    return cases;
}

}  // namespace matchlight
