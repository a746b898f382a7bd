#include "lighting/mirror_ball.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "synthetic_probes.h"

namespace matchlight {
namespace {

const MirrorBall ball{{0.1, -0.2, 0.3}, 0.05};

TEST(MirrorBall, ReflectsByTheLaw) {
    std::mt19937 random(1);
    const Eigen::Vector3d eye(1, 0.5, 0.8);
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d at = ball.centre_m + 0.06 * test::random_direction(random);
        const Eigen::Vector3d ray = (at - eye).normalized();
        const auto hit = hit_ball(ball, eye, ray);
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR((hit->point_m - ball.centre_m).norm(), ball.radius_m, 1e-12);
        EXPECT_NEAR(hit->normal.dot(hit->reflected), hit->cosine, 1e-9);   // equal angles
        EXPECT_NEAR(hit->normal.dot(ray.cross(hit->reflected)), 0, 1e-9);  // in one plane
        EXPECT_GT(hit->cosine, 0);
    }
    EXPECT_GT(hits, 500);
}

TEST(MirrorBall, ADirectionIsFoundAgainWhereItIsSeen) {
    std::mt19937 random(2);
    for (const double distance_m : {0.06, 0.3, 3.0, 3e4}) {
        const Eigen::Vector3d eye = ball.centre_m + distance_m * Eigen::Vector3d(0.3, -0.8, 0.5).normalized();
        for (int i = 0; i < 300; ++i) {
            const Eigen::Vector3d towards = test::random_direction(random);
            const auto hit = hit_reflecting_direction(ball, eye, towards);
            if (!hit) continue;
            EXPECT_LT((hit->reflected - towards).norm(), 1e-8) << distance_m;
        }
        EXPECT_FALSE(hit_reflecting_direction(ball, eye, (ball.centre_m - eye).normalized()))
            << "straight behind the ball nothing is seen";
        const auto straight = hit_reflecting_direction(ball, eye, (eye - ball.centre_m).normalized());
        ASSERT_TRUE(straight);
        EXPECT_NEAR(straight->cosine, 1, 1e-12);
    }
}

TEST(MirrorBall, APlaceIsFoundAgainWhereItIsSeen) {
    std::mt19937 random(3);
    const Eigen::Vector3d eye(1, 0.5, 0.8);
    int seen = 0;
    for (int i = 0; i < 500; ++i) {
        const Eigen::Vector3d place = ball.centre_m + (0.06 + 0.001 * i) * test::random_direction(random);
        const auto hit = hit_reflecting_place(ball, eye, place);
        if (!hit) continue;
        ++seen;
        EXPECT_LT(((place - hit->point_m).normalized() - hit->reflected).norm(), 1e-7);
    }
    EXPECT_GT(seen, 250);
    EXPECT_FALSE(hit_reflecting_place(ball, eye, ball.centre_m + Eigen::Vector3d(0.01, 0, 0)));
}

TEST(MirrorBall, TheSolidAngleOfAPixelIsThatOfItsCornersReflections) {
    const Eigen::Vector3d eye = ball.centre_m + Eigen::Vector3d(0, -0.7, 0);
    for (const double off : {0.0, 0.02, 0.035, 0.045}) {
        const Eigen::Vector3d ray = (ball.centre_m + Eigen::Vector3d(off, 0, 0.3 * off) - eye).normalized();
        const auto hit = hit_ball(ball, eye, ray);
        ASSERT_TRUE(hit);
        constexpr double step = 1e-6;
        const Eigen::Vector3d across = ray.cross(Eigen::Vector3d::UnitZ()).normalized(), up = ray.cross(across);
        const Eigen::Vector3d right = hit_ball(ball, eye, (ray + step * across).normalized())->reflected;
        const Eigen::Vector3d above = hit_ball(ball, eye, (ray + step * up).normalized())->reflected;
        const double numeric = (right - hit->reflected).cross(above - hit->reflected).norm() / (step * step);
        const double formula = reflected_solid_angle_ratio(ball, (hit->point_m - eye).norm(), hit->cosine);
        EXPECT_NEAR(formula / numeric, 1, 1e-3) << off;
    }
}

TEST(MirrorBall, FarAwayTheEdgeStaysWhereItIs) {
    // In single precision a textbook discriminant misses by a per cent at ten thousand radii (Haines et al. 2019).
    const MirrorBall far{{0, 0, 1e5}, 1};
    int hits = 0;
    constexpr int rays = 2000;
    for (int i = 0; i < rays; ++i) {
        const double x = 1.2 * (i + 0.5) / rays;
        const bool hit = hit_ball(far, Eigen::Vector3d::Zero(), Eigen::Vector3d(x, 0, 1e5).normalized()).has_value();
        if (hit) ++hits;
        EXPECT_EQ(hit, x < 1) << x;
    }
    EXPECT_NEAR(hits / (rays / 1.2), 1, 1e-3);
}

TEST(MirrorBall, GrazingLightIsSentBackWhole) {
    EXPECT_DOUBLE_EQ(fresnel_reflectance(0.6, 1), 0.6);
    EXPECT_DOUBLE_EQ(fresnel_reflectance(0.6, 0), 1);
    EXPECT_NEAR(fresnel_reflectance(0.6, 0.5), 0.6 + 0.4 / 32, 1e-12);
}

}  // namespace
}  // namespace matchlight
