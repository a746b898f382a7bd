// Reach must hold every pixel that a body can touch, and not the whole frame.
#include "compositor/reach.h"

#include <random>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

Camera test_camera() {
    Camera camera;
    camera.width = 640;
    camera.height = 360;
    camera.fx = camera.fy = 622;
    camera.cx = 319.5;
    camera.cy = 179.5;
    camera.distortion = {-0.2, 0.05, 0.001, -0.002, 0};
    return camera;
}

RigidTransform looking_down_from(double height_m) {
    RigidTransform camera_from_world = RigidTransform::Identity();
    camera_from_world.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    camera_from_world.translation() = Eigen::Vector3d(0, 0, height_m);
    return camera_from_world;
}

TEST(Reach, HoldsEveryPointOfABox) {
    const Camera camera = test_camera();
    const LensMap map = make_lens_map(camera);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < 50; ++trial) {
        RigidTransform camera_from_world = looking_down_from(0.5);
        camera_from_world.rotate(Eigen::AngleAxisd(unit(random) - 0.5, Eigen::Vector3d::UnitX()));
        const Eigen::Vector3d low(unit(random) * 0.4 - 0.2, unit(random) * 0.4 - 0.2, 0);
        const Eigen::AlignedBox3d box(low, low + Eigen::Vector3d(0.1, 0.05, 0.08));
        const Region region = plate_region(normalized_bounds_of_box(box, camera_from_world, map), camera, map, 0);
        for (int i = 0; i < 200; ++i) {
            const Eigen::Vector3d point =
                box.min() + Eigen::Vector3d(unit(random), unit(random), unit(random)).cwiseProduct(box.sizes());
            const Eigen::Vector2d pixel = camera.pixel_from_camera(camera_from_world * point);
            const Eigen::Vector2i nearest = pixel.array().round().cast<int>();
            if (!Region{0, 0, camera.width, camera.height}.contains(nearest.x(), nearest.y())) continue;
            EXPECT_TRUE(region.contains(nearest.x(), nearest.y())) << pixel.transpose();
        }
        EXPECT_LT(region.width * region.height, camera.width * camera.height);
    }
}

TEST(Reach, WhatIsBesideTheFrameReachesIntoItByTheMargin) {
    for (const bool bent : {false, true}) {
        Camera camera = test_camera();
        if (!bent) camera.distortion = {};
        const LensMap map = make_lens_map(camera);
        // From half a metre's height half the frame is 0.257 m; the box begins 12 to 13 px beside it.
        const Eigen::AlignedBox3d box(Eigen::Vector3d(0.2675, -0.02, 0), Eigen::Vector3d(0.3, 0.02, 1e-6));
        const RigidTransform view = looking_down_from(0.5);
        if (!bent) {
            EXPECT_TRUE(normalized_bounds_of_box(box, view, map).isEmpty());
        }
        const auto region = [&](int margin_px) {
            return plate_region(normalized_bounds_of_box(box, view, map, margin_px / camera.fx), camera, map,
                                margin_px);
        };
        EXPECT_TRUE(bent || region(8).empty());
        const Region reached = region(60);
        EXPECT_FALSE(reached.empty());
        EXPECT_EQ(reached.x + reached.width, camera.width);
        EXPECT_GT(reached.width, 40);
        EXPECT_LT(reached.width, 85);
        EXPECT_LT(reached.height, 190);
    }
}

TEST(Reach, IsEmptyBehindTheCamera) {
    const Camera camera = test_camera();
    const LensMap map = make_lens_map(camera);
    const Eigen::AlignedBox3d behind(Eigen::Vector3d(-1, -1, 1), Eigen::Vector3d(1, 1, 2));
    EXPECT_TRUE(plate_region(normalized_bounds_of_box(behind, looking_down_from(0.5), map), camera, map, 2).empty());
}

TEST(Reach, AFloorThatPassesUnderTheCameraIsCutAtTheNearPlane) {
    const Camera camera = test_camera();
    const LensMap map = make_lens_map(camera);
    RigidTransform level = RigidTransform::Identity();  // looks along world +y, 0.3 m above the floor
    level.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    level.translation() = Eigen::Vector3d(0, 0.3, 0);
    const Eigen::AlignedBox2d floor(Eigen::Vector2d(-5, -5), Eigen::Vector2d(5, 5));
    const Region region = plate_region(normalized_bounds_of_rectangle(floor, 0, level, map), camera, map, 0);
    EXPECT_FALSE(region.empty());
    EXPECT_GT(region.y, 150);  // nothing of the floor above the horizon, which is the middle row
    EXPECT_EQ(region.y + region.height, camera.height);
}

}  // namespace
}  // namespace matchlight
