#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "lighting/ball_parallax.h"
#include "lighting/ball_probe.h"
#include "lighting/latlong_grid.h"
#include "lighting/semi_global.h"
#include "report/synthetic_ball.h"

namespace matchlight {
namespace {

using std::numbers::pi;
const MirrorBall ball{{0.02, -0.01, 0.05}, 0.035};
constexpr double lamp_radiance = 2000, lamp_radius = 1.5 * pi / 180;
// A striped screen 15 cm from the ball, whose upper edge the ball's middle sees 24° above the horizon.
constexpr double screen_y = 0.14, screen_half_width = 0.06, edge = 24 * pi / 180;
const double screen_top = ball.centre_m.z() + (screen_y - ball.centre_m.y()) * std::tan(edge);
// The lamp lies behind it, 4° below the edge, farther than a pixel of the ball blurs it.
const Eigen::Vector3d lamp(0, std::cos(edge - 4 * pi / 180), std::sin(edge - 4 * pi / 180));
const Sky far_room = room_with_lamp(lamp, 0);

Eigen::Vector3d room_with_screen(const Eigen::Vector3d& place_m, const Eigen::Vector3d& towards) {
    const double distance_m = (screen_y - place_m.y()) / towards.y();
    const Eigen::Vector3d meets = place_m + distance_m * towards;
    if (distance_m > 0 && std::abs(meets.x() - ball.centre_m.x()) < screen_half_width && meets.z() < screen_top) {
        return Eigen::Vector3d(0.5, 0.1, 0.1) * (1 + 0.5 * std::sin(300 * meets.x()) * std::cos(250 * meets.z()));
    }
    if (towards.dot(lamp) > std::cos(lamp_radius)) return Eigen::Vector3d::Constant(lamp_radiance);
    return far_room(towards);
}

std::vector<BallView> two_views_of(const MirrorBall& of, const Camera& camera, const Sky& sky,
                                   const Surroundings& surroundings) {
    std::vector<BallView> views;
    for (const Eigen::Vector3d& eye : {Eigen::Vector3d(0.45, -0.2, 0.5), Eigen::Vector3d(-0.5, -0.15, 0.45)}) {
        BallShot shot;
        shot.camera = camera;
        shot.ball = of;
        shot.camera_from_world = looking_at(eye, of.centre_m);
        shot.near = surroundings;
        views.push_back(photographed(shot, sky));
        views.back().camera_from_world = shot.camera_from_world;
    }
    return views;
}

/// Two views of a ball 60 pixels in radius.
std::vector<BallView> two_views(const Surroundings& surroundings) {
    return two_views_of(ball, long_lens(200, 150, 1200), far_room, surroundings);
}

BallProbe probe_of(const std::vector<BallView>& views, bool parallax) {
    BallProbeOptions options;
    options.place_m = ball.centre_m;
    options.parallax = parallax ? BallParallax::full : BallParallax::off;
    return probe_from_balls({views, ball, Eigen::Vector3d::Ones(), std::nullopt, nullptr}, options);
}

/// Within 5° of the lamp, over what the lamp sends.
double lamp_share(const BallProbe& probe) {
    const int width = probe.radiance.width(), height = probe.radiance.height();
    const LatlongGrid grid(width, height);
    double energy = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (latlong_direction(x, y, width, height).dot(lamp) < std::cos(5 * pi / 180)) continue;
            energy += grid.solid_angle(y) * probe.radiance.at(x, y, 1);
        }
    }
    return energy / (lamp_radiance * 2 * pi * (1 - std::cos(lamp_radius)));
}

/// Shares of the directions that show the screen, well within it and above the ball's middle, whose distance is right,
/// and of those high up and opposite it that are far.
void expect_distances(const BallProbe& built) {
    const int width = built.nearness.width(), height = built.nearness.height();
    int screen = 0, right = 0, room = 0, far = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d towards = latlong_direction(x, y, width, height);
            const double distance_m = (screen_y - ball.centre_m.y()) / towards.y();
            const Eigen::Vector3d meets = ball.centre_m + distance_m * towards;
            const double nearness = built.nearness.at(x, y);
            if (distance_m > 0 && std::abs(meets.x() - ball.centre_m.x()) < 0.8 * screen_half_width &&
                meets.z() < screen_top - 0.01 && meets.z() > ball.centre_m.z()) {
                ++screen;
                // Half a pixel of the maps, seen from points of the ball that lie a radius apart, is 5 % of 15 cm.
                right += std::abs(nearness * distance_m - 1) < 0.05 ? 1 : 0;
            } else if (towards.y() < 0 || towards.z() > 0.8) {
                ++room;
                far += nearness == 0 ? 1 : 0;
            }
        }
    }
    ASSERT_GT(screen, 100);
    EXPECT_GT(right, 0.98 * screen) << right << " of " << screen;
    EXPECT_GT(far, 0.98 * room) << far << " of " << room;
}

TEST(BallDepth, ALampThatAScreenHidesFromTheProbesPlaceIsHidden) {
    const std::vector<BallView> views = two_views(room_with_screen);
    const BallProbe built = probe_of(views, true);
    expect_distances(built);
    // Both views see past the edge, 6° higher from their sides of the ball than from its middle.
    EXPECT_GT(lamp_share(probe_of(views, false)), 0.7);
    EXPECT_LT(lamp_share(built), 0.2);
    // 4° below the edge there is screen, 4° above there is wall, and no view shows either there.
    for (const double across : {-8.0, 0.0, 8.0}) {
        const double x = std::tan(across * pi / 180) * (screen_y - ball.centre_m.y());
        for (const double up : {-4.0, 4.0}) {
            const double z = std::tan(edge + up * pi / 180) * (screen_y - ball.centre_m.y());
            const Eigen::Vector3d towards = Eigen::Vector3d(x, screen_y - ball.centre_m.y(), z).normalized();
            const Eigen::Vector3d got = Probe{built.radiance}.radiance(towards);
            const bool red = got.x() > 2 * got.y();
            EXPECT_EQ(red, up < 0) << across << ' ' << up << ": " << got.transpose();
        }
    }
}

void expect_same_bits(const BallProbe& with, const BallProbe& without) {
    EXPECT_TRUE(std::ranges::equal(with.radiance.samples(), without.radiance.samples()));
    EXPECT_TRUE(std::ranges::equal(with.sigma.samples(), without.sigma.samples()));
    EXPECT_TRUE(std::ranges::equal(with.seen.samples(), without.seen.samples()));
}

TEST(BallDepth, WhatIsFarStaysAsItIs) {
    const std::vector<BallView> views = two_views({});
    const BallProbe with = probe_of(views, true), without = probe_of(views, false);
    expect_same_bits(with, without);
    EXPECT_TRUE(without.nearness.empty());
    for (const float nearness : with.nearness.samples()) EXPECT_EQ(nearness, 0);
}

/// Photographed from `eyes_deg` around the ball, from 20 radii, with `noise` times the light.
std::vector<BallView> views_around(const MirrorBall& of, double radius_px, const std::vector<double>& eyes_deg,
                                   double noise) {
    std::vector<BallView> views;
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (const double azimuth_deg : eyes_deg) {
        const double azimuth = azimuth_deg * pi / 180;
        BallShot shot;
        const int side = static_cast<int>(2.6 * radius_px);
        shot.camera = long_lens(side, side, 20 * radius_px);
        shot.ball = of;
        const Eigen::Vector3d from_ball(0.8 * std::cos(azimuth), 0.8 * std::sin(azimuth), 0.6);
        shot.camera_from_world = looking_at(of.centre_m + 20 * of.radius_m * from_ball, of.centre_m);
        views.push_back(photographed(shot, room_with_lamp(lamp, lamp_radiance)));
        views.back().camera_from_world = shot.camera_from_world;
        for (float& sample : views.back().radiance.samples()) {
            sample = static_cast<float>(std::max(0.0, sample * (1 + noise * normal(random))));
        }
    }
    return views;
}

TEST(BallDepth, FarRoomsOfOtherBallsBaselinesAndNoiseStayAsTheyAre) {
    struct Room {
        double radius_m, radius_px;
        std::vector<double> eyes_deg;
        double noise;
    };
    for (const Room& room : {Room{0.1, 20, {-90, -20}, 0.03}, Room{0.015, 30, {-130, -50}, 0},
                             Room{0.05, 20, {0, 140}, 0.03}, Room{0.035, 20, {-90, 20, 140}, 0.02}}) {
        const MirrorBall other{{0.3, -0.2, 1}, room.radius_m};
        const std::vector<BallView> views = views_around(other, room.radius_px, room.eyes_deg, room.noise);
        BallProbeOptions options;
        options.place_m = other.centre_m;
        const BallScene scene{views, other, Eigen::Vector3d::Ones(), std::nullopt, nullptr};
        const BallProbe with = probe_from_balls(scene, options);
        EXPECT_FALSE(with.nearness.empty()) << room.radius_m;
        options.parallax = BallParallax::off;
        expect_same_bits(with, probe_from_balls(scene, options));
    }
}

TEST(BallDepth, TheEdgeOfALampThatTwoViewsDrawDifferentlyIsNotNear) {
    // Found so: two pixels of the maps beside this lamp were taken for near, which moved some of its light.
    const Sky room = room_with_lamp(Eigen::Vector3d(0.3, 0.5, 0.8).normalized(), 500);
    const MirrorBall here{{0, 0, 0.05}, 0.035};
    const std::vector<BallView> views = two_views_of(here, long_lens(160, 120, 900), room, {});
    const BallScene scene{views, here, Eigen::Vector3d::Ones(), std::nullopt, nullptr};
    BallProbeOptions options;
    options.place_m = here.centre_m;
    const BallProbe with = probe_from_balls(scene, options);
    options.parallax = BallParallax::off;
    expect_same_bits(with, probe_from_balls(scene, options));
}

TEST(BallDepth, ViewsFromOneSideHaveNoneAndLeavingItOutChangesNoBit) {
    for (const std::vector<double>& eyes_deg : {std::vector<double>{-90}, {-90, -90}, {-90, -88}}) {
        const std::vector<BallView> views = views_around(ball, 20, eyes_deg, 0.02);
        const BallProbe with = probe_of(views, true);
        EXPECT_TRUE(with.nearness.empty());
        expect_same_bits(with, probe_of(views, false));
    }
}

TEST(BallDepth, APlaceIsSeenWhereItsReflectionIs) {
    const Eigen::Vector3d eye(0.5, -0.45, 0.35);
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(0.1, 0.05, 0.1), Eigen::Vector3d(-0.2, 0.3, 0.4), Eigen::Vector3d(3, -2, 1)}) {
        const auto hit = hit_reflecting_place(ball, eye, place);
        ASSERT_TRUE(hit);
        Eigen::Vector3d normal =
            ((eye - ball.centre_m).normalized() + (place - ball.centre_m).normalized()).normalized();
        const SeenPlace seen = seen_place(ball, eye, place, 5, normal);
        // A hundredth of a step of parallax, which is 0.006 rad here.
        EXPECT_LT((seen.towards - hit->reflected).norm(), 6e-5) << place.transpose();
        EXPECT_NEAR(seen.nearness * (place - hit->point_m).norm(), 1, 1e-3);
    }
}

TEST(SemiGlobal, AGapTakesTheLabelsAroundItAndAnEdgeOfThePictureKeepsItsJump) {
    constexpr int size = 24, labels = 6;
    LabelCosts costs(size, size, labels);
    ImageF guide(size, size, 1);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const bool right = x >= size / 2;
            guide.at(x, y) = right ? 1.F : 0.F;
            // A gap of 5 × 5 pixels tells nothing.
            const bool gap = std::abs(x - 6) <= 2 && std::abs(y - 12) <= 2;
            for (int l = 0; l < labels; ++l) costs.at(x, y)[l] = gap || l == (right ? 4 : 1) ? 0.F : 0.5F;
        }
    }
    const LabelCosts sums = semi_global_sums(costs, guide, {0.1F, 1.F, 0.5F});
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const float* sum = sums.at(x, y);
            EXPECT_EQ(std::min_element(sum, sum + labels) - sum, x >= size / 2 ? 4 : 1) << x << ' ' << y;
        }
    }
}

}  // namespace
}  // namespace matchlight
