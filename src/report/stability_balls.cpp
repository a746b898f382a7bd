// Photographs of a mirror ball at their worst: tiny, huge, and with a sun in the room.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
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

/// How far the outline lies from the true one where the ball stands `clear_px` inside the picture's edge.
double outline_error_at_edge_px(double radius_px, double clear_px) {
    BallShot shot = shot_of(radius_px);
    const double middle_px = shot.camera.pixel_from_camera(shot.camera_from_world * shot.ball.centre_m).x();
    shot.camera.cx += radius_px + clear_px - middle_px;
    const BallView view = photographed(shot, room_with_lamp(lamp, 500), 4);
    const Eigen::Vector3d centre = shot.camera_from_world * shot.ball.centre_m;
    const BallOutline found = find_ball(view.radiance, shot.camera, std::nullopt, "synthetic ball");
    return (shot.camera.pixel_from_camera(found.axis) - shot.camera.pixel_from_camera(centre.normalized())).norm();
}

/// A ball of 40 pixels seen from so many degrees around it, noise of 3 % on its light, times `gain`.
std::vector<BallView> views_around(const std::vector<double>& azimuths_deg, float gain) {
    std::vector<BallView> views;
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    for (const double azimuth_deg : azimuths_deg) {
        BallShot shot = shot_of(20);
        const double azimuth = azimuth_deg * std::numbers::pi / 180;
        const Eigen::Vector3d from_ball(0.8 * std::cos(azimuth), 0.8 * std::sin(azimuth), 0.6);
        shot.camera = long_lens(56, 56, 400);
        shot.camera_from_world = looking_at(shot.ball.centre_m + 0.7 * from_ball, shot.ball.centre_m);
        views.push_back(photographed(shot, room_with_lamp(lamp, 500)));
        views.back().camera_from_world = shot.camera_from_world;
        for (float& sample : views.back().radiance.samples()) {
            sample = gain * std::max(0.F, sample * (1 + 0.03F * normal(random)));
        }
    }
    return views;
}

BallProbe probe_of(const std::vector<BallView>& views, BallParallax parallax) {
    const BallShot shot = shot_of(20);
    BallProbeOptions options;
    options.place_m = shot.ball.centre_m;
    options.parallax = parallax;
    return probe_from_balls({views, shot.ball, Eigen::Vector3d::Constant(shot.reflectance), std::nullopt, nullptr},
                            options);
}

/// Samples that parallax changes where nothing is near.
double changed_by_parallax(const std::vector<double>& azimuths_deg) {
    const std::vector<BallView> views = views_around(azimuths_deg, 1);
    const BallProbe with = probe_of(views, BallParallax::full), without = probe_of(views, BallParallax::off);
    double changed = 0;
    for (std::size_t i = 0; i < with.radiance.samples().size(); ++i) {
        changed += with.radiance.samples()[i] == without.radiance.samples()[i] ? 0 : 1;
    }
    return changed;
}

/// Samples of a probe from black photographs that are not 0.
double light_of_black() {
    const BallProbe probe = probe_of(views_around({-90, 0}, 0), BallParallax::full);
    double lit = 0;
    for (const float sample : probe.radiance.samples()) lit += sample == 0 ? 0 : 1;
    return lit;
}

/// In even light of 1, out to the rim where the ball reflects at grazing angles: the worst difference from 1.
double worst_of_even_light() {
    BallShot shot = shot_of(60);
    BallView view = photographed(shot, [](const Eigen::Vector3d&) { return Eigen::Vector3d::Ones().eval(); });
    view.camera_from_world = shot.camera_from_world;
    const std::vector<BallView> views = {view};
    const BallProbe probe =
        probe_from_balls({views, shot.ball, Eigen::Vector3d::Constant(shot.reflectance), std::nullopt, nullptr}, {});
    double worst = 0;
    for (const float sample : probe.radiance.samples()) worst = std::max(worst, std::abs(sample - 1.0));
    return worst;
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
    cases.push_back({"mirror ball", "of 80 pixels, 3 from the picture's edge", "middle off by, px", {0, 0.4}, {}, [] {
                         return StabilityOutcome{outline_error_at_edge_px(40, 3)};
                     }});
    // At the rim the reflectance bends within a pixel, which holds its mean.
    cases.push_back({"mirror ball", "in even light, out to its rim", "worst difference from it", {0, 0.02}, {}, [] {
                         return StabilityOutcome{worst_of_even_light()};
                     }});
    cases.push_back({"mirror ball", "black in every photograph", "samples that are not 0", {0, 0}, {}, [] {
                         return StabilityOutcome{light_of_black()};
                     }});
    for (const auto& [name, azimuths_deg] : std::vector<std::pair<std::string, std::vector<double>>>{
             {"one view", {-90}},
             {"two views from one place", {-90, -90}},
             {"two views 3 degrees apart", {-90, -87}},
             {"two views of a far room, noise of 3 %", {-90, -10}},
             {"three views of a far room, noise of 3 %", {-90, 20, 150}}}) {
        cases.push_back({"parallax", name, "samples that it changes", {0, 0}, {}, [azimuths = azimuths_deg] {
                             return StabilityOutcome{changed_by_parallax(azimuths)};
                         }});
    }
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
