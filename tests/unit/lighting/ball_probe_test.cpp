#include "lighting/ball_probe.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/error.h"
#include "lighting/ball_build.h"
#include "lighting/ball_register.h"
#include "lighting/ball_shadow.h"
#include "lighting/latlong_grid.h"
#include "report/synthetic_ball.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

const Eigen::Vector3d lamp = Eigen::Vector3d(0.3, 0.5, 0.8).normalized();
constexpr double lamp_radiance = 2000;
const Sky room = room_with_lamp(lamp, lamp_radiance);
const MirrorBall ball{{0.02, -0.01, 0.05}, 0.035};

BallShot shot_from(const Eigen::Vector3d& eye_m, int width = 320) {
    BallShot shot;
    // A ball of 95 pixels' radius fills the frame.
    shot.camera = long_lens(width, width * 3 / 4, 6 * width);
    shot.ball = ball;
    shot.camera_from_world = looking_at(eye_m, ball.centre_m + Eigen::Vector3d(0.004, 0.003, -0.002));
    return shot;
}

/// Posed and outlined exactly.
BallView exact_view(const BallShot& shot) {
    BallView view = photographed(shot, room);
    view.camera_from_world = shot.camera_from_world;
    const Eigen::Vector3d centre = shot.camera_from_world * ball.centre_m;
    view.outline.axis = centre.normalized();
    view.outline.half_angle = std::asin(ball.radius_m / centre.norm());
    return view;
}

Probe probe_of(const BallProbe& built) {
    return {built.radiance};
}

Eigen::Vector3d energy_around(const Probe& probe, const Eigen::Vector3d& direction, double radius_deg,
                              Eigen::Vector3d* centroid) {
    const LatlongGrid grid(probe.latlong.width(), probe.latlong.height());
    Eigen::Vector3d energy = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            const Eigen::Vector3d towards = latlong_direction(x, y, grid.width(), grid.height());
            if (towards.dot(direction) < std::cos(radius_deg * std::numbers::pi / 180)) continue;
            const Eigen::Vector3d light =
                Eigen::Map<const Eigen::Vector3f>(probe.latlong.pixel(x, y)).cast<double>() * grid.solid_angle(y);
            energy += light;
            sum += towards * light.sum();
        }
    }
    if (centroid != nullptr) *centroid = sum.normalized();
    return energy;
}

TEST(BallProbe, TwoViewsGiveTheRoomBack) {
    const std::vector<BallView> views = {exact_view(shot_from({0.5, -0.45, 0.35})),
                                         exact_view(shot_from({-0.55, -0.4, 0.3}))};
    const BallScene scene{views, ball, Eigen::Vector3d::Ones(), std::nullopt, nullptr};
    const BallProbe built = probe_from_balls(scene, {});
    EXPECT_GT(built.coverage, 0.99);
    EXPECT_EQ(built.radiance.height(), natural_height(views, ball));

    const Probe truth = test::probe_of(512, room);
    std::mt19937 random(4);
    for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d normal = test::random_direction(random);
        const Eigen::Vector3d got = irradiance(probe_of(built), normal), wanted = irradiance(truth, normal);
        // Most of it comes from a lamp six pixels wide.
        EXPECT_LT((got - wanted).norm() / wanted.norm(), 0.02) << normal.transpose();
    }
    Eigen::Vector3d direction;
    const Eigen::Vector3d energy = energy_around(probe_of(built), lamp, 8, &direction);
    const double wanted = lamp_radiance * 2 * std::numbers::pi * (1 - std::cos(3 * std::numbers::pi / 180));
    EXPECT_NEAR(energy.y() / wanted, 1, 0.02);
    EXPECT_LT(std::acos(std::min(1.0, direction.dot(lamp))) * 180 / std::numbers::pi, 0.1);
}

TEST(BallProbe, ReflectanceIsTakenOutAtEveryAngle) {
    BallShot shot = shot_from({0.5, -0.45, 0.35});
    shot.reflectance = 0.55;
    const Sky furnace = [](const Eigen::Vector3d&) { return Eigen::Vector3d::Ones().eval(); };
    BallView view = photographed(shot, furnace);
    view.camera_from_world = shot.camera_from_world;
    const std::vector<BallView> views = {view};
    const BallProbe built = probe_from_balls({views, ball, Eigen::Vector3d::Constant(0.55), std::nullopt, nullptr}, {});
    double sum = 0;
    const LatlongGrid grid(built.radiance.width(), built.radiance.height());
    for (int y = 0; y < built.radiance.height(); ++y) {
        for (int x = 0; x < built.radiance.width(); ++x) {
            // Close to the rim the reflectance bends within a pixel, which holds its mean.
            EXPECT_NEAR(built.radiance.at(x, y), 1, 0.02);
            sum += grid.solid_angle(y) * built.radiance.at(x, y);
        }
    }
    EXPECT_NEAR(sum / (4 * std::numbers::pi), 1, 1e-3);
}

TEST(BallProbe, ThePhotographerDisappears) {
    std::vector<BallView> views;
    for (const Eigen::Vector3d& eye : {Eigen::Vector3d(0.5, -0.45, 0.35), Eigen::Vector3d(-0.55, -0.4, 0.3)}) {
        BallShot shot = shot_from(eye);
        shot.blob = std::cos(6 * std::numbers::pi / 180);
        views.push_back(exact_view(shot));
    }
    const BallScene scene{views, ball, Eigen::Vector3d::Ones(), std::nullopt, nullptr};
    BallProbeOptions options;
    options.camera_deg = 8;
    const BallProbe built = probe_from_balls(scene, options);
    for (const BallView& view : views) {
        const Eigen::Vector3d towards = (view.eye_m() - ball.centre_m).normalized();
        const Eigen::Vector3d got = probe_of(built).radiance(towards), wanted = room(towards);
        EXPECT_LT((got - wanted).norm() / wanted.norm(), 0.05);
    }
    // One view alone has nothing else to show there, and says so by keeping it.
    const std::vector<BallView> one = {views.front()};
    const BallProbe single = probe_from_balls({one, ball, Eigen::Vector3d::Ones(), std::nullopt, nullptr}, options);
    const Eigen::Vector3d towards = (one.front().eye_m() - ball.centre_m).normalized();
    EXPECT_LT(probe_of(single).radiance(towards).norm(), 0.1 * room(towards).norm());
    EXPECT_LT(single.coverage, 1);
}

TEST(BallProbe, WhatNoViewShowsIsFilledAndSaid) {
    const std::vector<BallView> views = {exact_view(shot_from({0.5, -0.45, 0.35}))};
    const BallProbe built = probe_from_balls({views, ball, Eigen::Vector3d::Ones(), std::nullopt, nullptr}, {});
    const Eigen::Vector3d behind = (ball.centre_m - views.front().eye_m()).normalized();
    const Eigen::Vector2d at = latlong_pixel(behind, built.seen.width(), built.seen.height());
    const int x = static_cast<int>(std::lround(at.x())) % built.seen.width(), y = static_cast<int>(std::lround(at.y()));
    EXPECT_EQ(built.seen.at(x, y), 0);
    EXPECT_GT(built.radiance.at(x, y, 1), 0.05F);
    EXPECT_EQ(built.sigma.at(x, y), 1);
}

TEST(BallProbe, ClippedLightIsMarked) {
    BallView view = exact_view(shot_from({0.5, -0.45, 0.35}));
    view.clipped = Image8(view.radiance.width(), view.radiance.height(), 1);
    for (int y = 0; y < view.clipped.height(); ++y) {
        for (int x = 0; x < view.clipped.width(); ++x) {
            if (view.radiance.at(x, y, 1) < 100) continue;
            view.clipped.at(x, y) = 255;
            for (int c = 0; c < 3; ++c) view.radiance.at(x, y, c) = 100;
        }
    }
    const std::vector<BallView> views = {view};
    const BallProbe built = probe_from_balls({views, ball, Eigen::Vector3d::Ones(), std::nullopt, nullptr}, {});
    const double lamp_share = (1 - std::cos(3 * std::numbers::pi / 180)) / 2;
    EXPECT_GT(built.clipped_share, 0.5 * lamp_share);
    EXPECT_LT(built.clipped_share, 3 * lamp_share);
}

TEST(BallShadow, AWhiteFurnaceHasNone) {
    const RigPlane plane{{0, 0, 0}, Eigen::Vector3d::UnitZ()};
    const BallShadow shadow(test::furnace(64, 3), plane, {{0, 0, 0.035}, 0.035}, Eigen::Vector3d::Ones());
    for (const double x : {0.005, 0.02, 0.06, 0.3}) {
        EXPECT_LT((shadow.unshadowed_over_seen({x, 0, 0}) - Eigen::Vector3d::Ones()).norm(), 1e-3) << x;
    }
}

TEST(BallShadow, LightsThePlaneWithWhatThePlaneSendsUpToTheBall) {
    const RigPlane plane{{0, 0, 0}, Eigen::Vector3d::UnitZ()};
    const BallShadow shadow(test::furnace(64, 3), plane, {{0, 0, 0.035}, 0.035}, Eigen::Vector3d::Ones());
    for (const double x : {0.005, 0.02, 0.06}) {
        const auto seen = [&](double ground) {
            return 1 /
                   shadow
                       .unshadowed_over_seen(
                           {x, 0, 0}, [&](const Eigen::Vector3d&) { return Eigen::Vector3d::Constant(ground).eval(); })
                       .y();
        };
        EXPECT_NEAR(seen(3), 1, 1e-3) << x;  // the furnace again
        EXPECT_LT(seen(0), 0.97) << x;
        EXPECT_NEAR(seen(1.5), (seen(0) + seen(3)) / 2, 1e-9) << x;  // light adds up
    }
}

TEST(BallShadow, OfALampOverheadIsAsDarkAsTheLampIsBright) {
    const RigPlane plane{{0, 0, 0}, Eigen::Vector3d::UnitZ()};
    // A lamp of 12° radius straight above, sending nine tenths of the irradiance.
    const double share = std::pow(std::sin(12 * std::numbers::pi / 180), 2);
    const double radiance = 9 / share;
    const Probe sky = test::probe_of(128, [&](const Eigen::Vector3d& d) {
        return Eigen::Vector3d::Constant(d.z() > std::cos(12 * std::numbers::pi / 180) ? radiance : 1.0).eval();
    });
    const BallShadow shadow(sky, plane, {{0, 0, 0.1}, 0.035}, Eigen::Vector3d::Constant(1e-6));
    const double middle = shadow.unshadowed_over_seen({0, 0, 0}).y();
    EXPECT_GT(middle, 8);
    EXPECT_NEAR(shadow.unshadowed_over_seen({0.3, 0, 0}).y(), 1, 0.05);
}

TEST(BallRegister, FindsTheTurnBetweenViewsWithoutTags) {
    std::vector<BallView> views = {exact_view(shot_from({0.02, -0.7, 0.25})),
                                   exact_view(shot_from({-0.6, -0.2, 0.35}))};
    const std::vector<BallView> truth = views;
    for (BallView& view : views) view.camera_from_world.reset();
    Warnings warnings;
    warnings.set_quiet(true);
    register_views(views, ball.radius_m, warnings);
    // Known only up to the first view's own axes.
    const Eigen::Matrix3d got = views[1].camera_from_world->linear() * views[0].camera_from_world->linear().transpose();
    const Eigen::Matrix3d wanted =
        truth[1].camera_from_world->linear() * truth[0].camera_from_world->linear().transpose();
    EXPECT_LT(Eigen::AngleAxisd(got * wanted.transpose()).angle() * 180 / std::numbers::pi, 1);
    // +y is where the first photographer looks.
    EXPECT_GT((-views[0].eye_m()).normalized().y(), 0.999);
}

TEST(BallBuild, WithoutTagsTheLightTurnsWithThePhotographerAndAMatteBallTellsItsStrength) {
    BallShot shot = shot_from({0.02, -0.7, 0.05});
    shot.backdrop = Eigen::Vector3d(0.35, 0.33, 0.3);
    BallView mirror = photographed(shot, room);
    // A tenth of the lamp is what the photographs hold.
    constexpr float limit = lamp_radiance / 10;
    mirror.clipped = Image8(mirror.camera.width, mirror.camera.height, 1);
    for (int y = 0; y < mirror.camera.height; ++y) {
        for (int x = 0; x < mirror.camera.width; ++x) {
            float* radiance = mirror.radiance.pixel(x, y);
            if (radiance[1] < limit) continue;
            mirror.clipped.at(x, y) = 255;
            std::fill_n(radiance, 3, limit);
        }
    }
    const Probe walls = test::probe_of(32, room_with_lamp(lamp, 0));
    const double lamp_irradiance = lamp_radiance * std::numbers::pi * std::pow(std::sin(3 * std::numbers::pi / 180), 2);
    BallBuildOptions options;
    options.ball_radius_m = ball.radius_m;
    options.diffuse_ball.emplace();
    options.diffuse_ball->view =
        photographed_matte(shot, {0.5, 0.5, 0.5}, [&](const Eigen::Vector3d& normal) -> Eigen::Vector3d {
            const double lit = std::max(0.0, normal.dot(lamp)) * lamp_irradiance;
            return irradiance(walls, normal) + Eigen::Vector3d::Constant(lit);
        });
    options.diffuse_ball->view.camera_from_world.reset();
    Warnings warnings;
    warnings.set_quiet(true);
    const BallBuild build = build_ball_probe({mirror}, options, warnings);
    Eigen::Vector3d direction;
    const Eigen::Vector3d energy = energy_around(probe_of(build.probe), lamp, 5, &direction);
    // He looks along +y, within the little that the ball lies off the middle of his picture.
    EXPECT_LT(std::acos(std::min(1.0, direction.dot(lamp))) * 180 / std::numbers::pi, 1.5);
    EXPECT_EQ(build.reflectance_by, "taken as 1");
    EXPECT_EQ(build.clipped_lights_by, "the diffuse ball");
    ASSERT_EQ(build.clipped_lights.size(), 1U);
    // Pixels that the lamp covers in part are no lower bound, so the gain is not ten; the energy is what counts.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(energy[c], lamp_irradiance, 0.1 * lamp_irradiance);
}

}  // namespace
}  // namespace matchlight
