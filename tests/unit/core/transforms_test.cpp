// Frames and axes against hand-worked answers.
#include "core/transforms.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(Transforms, ModelAxesTurnYUpIntoZUp) {
    const Eigen::Vector3d world = world_from_model_axes() * Eigen::Vector3d(1, 2, 3);
    EXPECT_EQ(world, Eigen::Vector3d(1, -3, 2));
    EXPECT_DOUBLE_EQ(world_from_model_axes().determinant(), 1.0);
}

TEST(Transforms, RotateDegTurnsAboutXThenYThenZOfTheWorld) {
    // x-axis: 90° about z sends it to y.
    EXPECT_TRUE((rotation_from_degrees({0, 0, 90}) * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
    // y-axis: about x by 90° → z; then about y by 90° → x; then about z by 90° → y.
    EXPECT_TRUE((rotation_from_degrees({90, 90, 90}) * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(Transforms, DetectorCountsFromThePixelCorner) {
    // The centre of the first pixel is (0.5, 0.5) for AprilTag's library and (0, 0) here.
    EXPECT_EQ(pixel_from_detector({0.5, 0.5}), Eigen::Vector2d(0, 0));
}

TEST(Transforms, ClipAgreesWithThePinholeAtPixelCentres) {
    PinholeView view;
    view.fx = 600, view.fy = 610, view.cx = 319.5, view.cy = 179.5;
    view.origin_x = 100, view.origin_y = 50, view.width = 200, view.height = 120, view.near_m = 0.01;
    const Eigen::Vector3d point(0.03, -0.02, 0.7);
    const Eigen::Vector4d clip = clip_from_camera(view) * point.homogeneous();
    const double u = view.fx * point.x() / point.z() + view.cx;
    const double v = view.fy * point.y() / point.z() + view.cy;
    // Window coordinate w of pixel i's centre is i + ½ from the viewport's left edge.
    EXPECT_NEAR((clip.x() / clip.w() + 1) / 2 * view.width, u - view.origin_x + 0.5, 1e-9);
    EXPECT_NEAR((1 - clip.y() / clip.w()) / 2 * view.height, v - view.origin_y + 0.5, 1e-9);
    EXPECT_NEAR(clip.z() / clip.w(), view.near_m / point.z(), 1e-12);
}

TEST(Transforms, ACameraLooksAlongItsDirectionAndStandsUpright) {
    const Eigen::Vector3d eye(1, 2, 3), forward = Eigen::Vector3d(0.3, -0.8, -0.4).normalized();
    const RigidTransform camera_from_world = camera_looking_along(eye, forward);
    EXPECT_TRUE(is_rigid(camera_from_world.matrix(), 1e-12));
    EXPECT_LT((camera_from_world * Eigen::Vector3d(eye + 2 * forward) - Eigen::Vector3d(0, 0, 2)).norm(), 1e-12);
    const Eigen::Vector3d up = camera_from_world.linear() * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(up.x(), 0, 1e-12);
    EXPECT_LT(up.y(), 0);  // y runs down the picture
    // Straight down: the world's y at the top.
    const RigidTransform down = camera_looking_along(eye, -Eigen::Vector3d::UnitZ());
    EXPECT_LT((down.linear() * Eigen::Vector3d::UnitY() - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST(Transforms, RigidityIsRecognised) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    EXPECT_TRUE(is_rigid(matrix));
    matrix(0, 0) = 1.01;
    EXPECT_FALSE(is_rigid(matrix));
    matrix = Eigen::Matrix4d::Identity();
    matrix(2, 2) = -1;  // a mirror
    EXPECT_FALSE(is_rigid(matrix));
}

}  // namespace
}  // namespace matchlight
