#include "lighting/ball_outline.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/error.h"
#include "report/synthetic_ball.h"

namespace matchlight {
namespace {

BallShot shot_of(int width, double radius_px, const Eigen::Vector2d& off_px) {
    BallShot shot;
    shot.reflectance = 0.7;
    shot.backdrop = Eigen::Vector3d(0.35, 0.33, 0.3);
    shot.camera = long_lens(width, width * 3 / 4, 2.4 * width);
    const double distance_m = 0.7;
    shot.ball.radius_m = radius_px / shot.camera.fx * distance_m;
    const Eigen::Vector3d eye(0.2, -0.6, 0.3);
    shot.camera_from_world = looking_at(eye, eye + Eigen::Vector3d(0, 1, 0));
    const Eigen::Vector3d in_camera(distance_m * off_px.x() / shot.camera.fx, distance_m * off_px.y() / shot.camera.fx,
                                    distance_m);
    shot.ball.centre_m = shot.camera_from_world.inverse() * in_camera;
    return shot;
}

const Sky room = room_with_lamp(Eigen::Vector3d(0.3, 0.2, 0.9).normalized(), 500);

void expect_found(const BallShot& shot, const BallView& view, const std::optional<OutlineCircle>& given,
                  double tolerance_px) {
    const BallOutline outline = find_ball(view.radiance, shot.camera, given, "made.jpg");
    const Eigen::Vector3d centre = shot.camera_from_world * shot.ball.centre_m;
    const Eigen::Vector2d off =
        shot.camera.pixel_from_camera(outline.axis) - shot.camera.pixel_from_camera(centre.normalized());
    EXPECT_LT(off.norm(), tolerance_px);
    const double half_angle = std::asin(shot.ball.radius_m / centre.norm());
    EXPECT_LT(std::abs(outline.half_angle - half_angle) * shot.camera.fx, tolerance_px);
}

TEST(BallOutline, IsFoundToAFractionOfAPixelThroughTheLens) {
    const BallShot shot = shot_of(480, 74.3, {30.4, -21.7});
    // The outermost pixel of a mirror holds all that lies behind it and is more often like the backdrop than not.
    expect_found(shot, photographed(shot, room), {}, 0.4);
}

TEST(BallOutline, OfTwentyPixelsIsFoundToo) {
    const BallShot shot = shot_of(320, 10, {-31.2, 14.9});
    expect_found(shot, photographed(shot, room), {}, 0.4);
}

TEST(BallOutline, AMatteBallBeforeBlackClothIsFound) {
    BallShot shot;
    shot.ball = {{0, 0, 0.05}, 0.035};
    shot.camera = long_lens(320, 240, 6 * 320);
    shot.camera_from_world = looking_at({0.3, -0.6, 0.35}, shot.ball.centre_m);
    const Eigen::Vector3d lamp = Eigen::Vector3d(0.3, 0.5, 0.8).normalized();
    for (const double cloth : {0.0, 1e-4}) {
        shot.backdrop = Eigen::Vector3d::Constant(cloth);
        const BallView view = photographed_matte(shot, {0.5, 0.5, 0.5}, [&](const Eigen::Vector3d& normal) {
            return Eigen::Vector3d::Constant(1 + 10 * std::max(0.0, normal.dot(lamp))).eval();
        });
        const BallOutline found = find_ball(view.radiance, view.camera, std::nullopt, "matte");
        const Eigen::Vector3d centre = shot.camera_from_world * shot.ball.centre_m;
        const Eigen::Vector2d off =
            view.camera.pixel_from_camera(found.axis) - view.camera.pixel_from_camera(centre.normalized());
        // A ray a pixel: the outline has steps.
        EXPECT_LT(off.norm(), 0.3) << cloth;
        EXPECT_NEAR(found.half_angle, std::asin(shot.ball.radius_m / centre.norm()), 0.5 / view.camera.fx) << cloth;
    }
}

TEST(BallOutline, TheCircleByHandMayBeOffByATenth) {
    const BallShot shot = shot_of(400, 60, {11, 9});
    const Eigen::Vector2d centre = shot.camera.pixel_from_camera(shot.camera_from_world * shot.ball.centre_m);
    expect_found(shot, photographed(shot, room), OutlineCircle{centre + Eigen::Vector2d(2, -3), 63}, 0.4);
}

TEST(BallOutline, APictureWithoutABallIsRefused) {
    ImageF noise(320, 240, 3);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> light(0.2F, 1);
    for (float& sample : noise.samples()) sample = light(random);
    try {
        find_ball(noise, long_lens(320, 240, 700), {}, "empty.jpg");
        FAIL() << "a ball in noise";
    } catch (const InputError& error) {
        EXPECT_EQ(error.parts().file, "empty.jpg");
        EXPECT_NE(error.parts().cause.find("looked for a circle"), std::string::npos);
        EXPECT_NE(error.parts().cure.find("--circle"), std::string::npos);
    }
}

TEST(BallOutline, ABallThatTheFrameCutsIsRefused) {
    const BallShot shot = shot_of(400, 70, {160, 0});
    const Eigen::Vector2d centre = shot.camera.pixel_from_camera(shot.camera_from_world * shot.ball.centre_m);
    EXPECT_THROW(find_ball(photographed(shot, room).radiance, shot.camera, OutlineCircle{centre, 70}, "cut.jpg"),
                 InputError);
}

}  // namespace
}  // namespace matchlight
