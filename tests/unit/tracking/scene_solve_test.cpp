// A virtual camera's poses and lens are exactly what the scene says.
#include "tracking/scene_solve.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"

namespace matchlight {
namespace {

Scene scene_with_orbit(double elevation_deg) {
    Scene scene;
    scene.path = "scene.toml";
    scene.camera = CameraSettings{.width = 800,
                                  .height = 600,
                                  .frames = 5,
                                  .fps = 30,
                                  .vertical_fov_deg = 40,
                                  .orbit = {},
                                  .keys = {},
                                  .lens = {}};
    scene.camera->orbit = OrbitSettings{
        .target_m = {0.1, 0.2, 0.3}, .radius_m = 0.6, .elevation_deg = elevation_deg, .from_deg = -30, .to_deg = 90};
    return scene;
}

TEST(VirtualSolve, LooksAtItsTargetFromItsDistance) {
    for (const double elevation_deg : {-90.0, -20.0, 0.0, 30.0, 90.0}) {
        const Solve solve = virtual_solve(scene_with_orbit(elevation_deg));
        ASSERT_EQ(solve.frames.size(), 5u);
        for (const SolvedFrame& frame : solve.frames) {
            ASSERT_TRUE(frame.camera_from_world);
            EXPECT_TRUE(is_rigid(frame.camera_from_world->matrix(), 1e-12));
            EXPECT_NEAR(frame.camera_from_world->linear().determinant(), 1, 1e-12);
            const Eigen::Vector3d target = *frame.camera_from_world * Eigen::Vector3d(0.1, 0.2, 0.3);
            EXPECT_TRUE(target.isApprox(Eigen::Vector3d(0, 0, 0.6), 1e-12)) << target.transpose();
            EXPECT_DOUBLE_EQ(frame.time_s, static_cast<double>(frame.frame) / 30);
        }
    }
}

TEST(VirtualSolve, StandsUpright) {
    const Solve solve = virtual_solve(scene_with_orbit(30));
    for (const SolvedFrame& frame : solve.frames) {
        const Eigen::Vector3d up = frame.camera_from_world->linear() * Eigen::Vector3d::UnitZ();
        EXPECT_NEAR(up.x(), 0, 1e-12);
        EXPECT_LT(up.y(), 0);  // the camera's y is down
    }
}

TEST(VirtualSolve, SpansTheAngleOfViewBetweenThePicturesEdges) {
    for (const auto& [width, height] : {std::pair(800, 600), {1, 1}, {7, 5}}) {
        Scene scene = scene_with_orbit(0);
        scene.camera->width = width;
        scene.camera->height = height;
        const Camera camera = virtual_solve(scene).camera;
        const double slope = std::tan(20 * std::numbers::pi / 180);
        EXPECT_NEAR(camera.pixel_from_normalized({0, -slope}).y(), -0.5, 1e-9);
        EXPECT_NEAR(camera.pixel_from_normalized({0, slope}).y(), height - 0.5, 1e-9);
        EXPECT_NEAR(camera.pixel_from_normalized({0, 0}).x(), (width - 1) / 2.0, 1e-9);
        EXPECT_EQ(camera.fx, camera.fy);
    }
}

TEST(VirtualSolve, KnowsTheCircleOfConfusion) {
    Scene scene = scene_with_orbit(0);
    scene.camera->lens = LensSettings{.f_number = 2, .focus_distance_m = 0.5, .sensor_width_mm = 36};
    const Solve solve = virtual_solve(scene);
    // Thin lens by hand: the sensor stands at v behind a lens of focal length f, focused at z_f; a point at z is
    // blurred to a disc of f/N · |v_z − v| / v_z on the sensor, v_z where its image would be.
    const double v = solve.camera.fx * 0.036 / 800;
    const double f = 1 / (1 / v + 1 / 0.5);
    const double z = 0.8;
    const double v_z = 1 / (1 / f - 1 / z);
    const double disc_px = f / 2 * std::abs(v_z - v) / v_z * 800 / 0.036;
    EXPECT_EQ(solve.frames[0].focus_distance_m, 0.5);
    EXPECT_NEAR(*solve.frames[0].coc_scale_px_m * std::abs(1 / 0.5 - 1 / z), disc_px, 1e-9);
}

TEST(VirtualSolve, RefusesToLookAtItsOwnEye) {
    Scene scene = scene_with_orbit(0);
    scene.camera->orbit.reset();
    scene.camera->keys = {{0, {-1, 0, 0}, {1, 0, 0}}, {4, {1, 0, 0}, {-1, 0, 0}}};  // they meet at frame 2
    try {
        virtual_solve(scene);
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_EQ(error.parts().frame, 2);
    }
}

TEST(VirtualSolve, KeepsTagsWhosePlaceIsGiven) {
    Scene scene = scene_with_orbit(0);
    scene.tags.rig.resize(2);
    scene.tags.rig[1].id = 7;
    scene.tags.rig[1].world_from_tag = RigidTransform::Identity();
    const Solve solve = virtual_solve(scene);
    ASSERT_EQ(solve.rig.size(), 1u);
    EXPECT_EQ(solve.rig[0].id, 7);
}

}  // namespace
}  // namespace matchlight
