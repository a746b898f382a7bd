// Pixels to rays, objects and planes, where the answer is known.
#include "preview/picking.h"

#include <cmath>

#include <gtest/gtest.h>

#include "../scene/model_test.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A lens whose corners are displaced by some twenty pixels.
Camera distorting_camera() {
    Camera camera;
    camera.width = 640;
    camera.height = 360;
    camera.fx = 520;
    camera.fy = 525;
    camera.cx = 322;
    camera.cy = 176;
    camera.distortion = {-0.2, 0.05, 0.001, -0.0007, 0};
    return camera;
}

/// 0.5 m above the table, looking down at a slant.
RigidTransform pose() {
    const Vector3d eye_m(0.1, -0.6, 0.5);
    return camera_looking_along(eye_m, (Vector3d(0, 0.02, 0) - eye_m).normalized());
}

ObjectSettings shape(const std::string& name, const Vector3d& translate_m, double scale) {
    ObjectSettings object;
    object.shape = name;
    object.translate_m = translate_m;
    object.scale.setConstant(scale);
    return object;
}

TEST(Picking, ARayLeadsThroughTheDistortedPixelOfItsPoints) {
    const Camera camera = distorting_camera();
    for (const Vector2d& pixel : {Vector2d(0, 0), Vector2d(639, 359), Vector2d(322, 176), Vector2d(77.25, 300.5)}) {
        const auto ray = ray_of_pixel(camera, pose(), pixel);
        ASSERT_TRUE(ray);
        for (const double depth_m : {0.05, 0.7, 40.0}) {
            EXPECT_NEAR((pose() * ray->at(depth_m)).z(), depth_m, 1e-12 * (1 + depth_m)) << "distances are depths";
            const auto back = pixel_of_point(camera, pose(), ray->at(depth_m));
            ASSERT_TRUE(back);
            // normalized_from_pixel() is exact to 1e-10 of normalised coordinates: 520 times that in pixels.
            EXPECT_LT((*back - pixel).norm(), 1e-6);
        }
        EXPECT_FALSE(pixel_of_point(camera, pose(), ray->at(-1))) << "behind the camera";
    }
}

TEST(Picking, PlanesAreMetWhereTheRayCrossesThem) {
    const PixelRay down{Vector3d(0.2, 0.3, 1), Vector3d(0.5, 0, -1)};
    const auto on_table = meet(down, level_plane(0.1));
    ASSERT_TRUE(on_table);
    EXPECT_LT((*on_table - Vector3d(0.65, 0.3, 0.1)).norm(), 1e-12);
    EXPECT_FALSE(meet(down, level_plane(2))) << "behind";
    EXPECT_FALSE(meet({Vector3d(0, 0, 1), Vector3d::UnitX()}, level_plane(0))) << "along it";

    Solve solve;
    SolvedTag tag;
    tag.id = 3;
    tag.world_from_tag = RigidTransform::Identity();
    tag.world_from_tag.linear() = rotation_from_degrees({0, 90, 0});  // its face looks along world +x
    tag.world_from_tag.translation() = Vector3d(0.4, 0, 0);
    solve.rig.push_back(tag);
    const auto on_tag = plane_of_tag(solve, 3);
    ASSERT_TRUE(on_tag);
    const auto met = meet(down, *on_tag);
    ASSERT_TRUE(met);
    EXPECT_LT((*met - Vector3d(0.4, 0.3, 0.6)).norm(), 1e-12);
    EXPECT_FALSE(plane_of_tag(solve, 4));

    Scene scene;
    scene.objects.push_back(shape("box", {0, 0, 0.25}, 1));
    EXPECT_NEAR(plane_of_object(scene, 0, solve, {}).signedDistance(Vector3d(5, 5, 0.25)), 0, 1e-12);
    scene.objects[0].parent_tag = 3;
    EXPECT_NEAR(plane_of_object(scene, 0, solve, {}).signedDistance(Vector3d(0.65, 5, 5)), 0, 1e-12);
}

TEST(Picking, TheNearestObjectIsMetWhereItStands) {
    const Camera camera = distorting_camera();
    Scene scene;
    scene.objects = {shape("sphere", {0, 0, 0.05}, 0.1), shape("box", {0, 0.3, 0.05}, 0.1)};
    PickTargets targets;
    targets.set_scene(scene);
    const auto pick = [&](const Vector3d& towards_m) {
        const auto ray = ray_of_pixel(camera, pose(), *pixel_of_point(camera, pose(), towards_m));
        return targets.first(*ray, placements_of(scene, {}, {}), scene.surface);
    };
    const Vector3d eye_m = pose().inverse().translation();
    const auto ball = pick({0, 0, 0.05});
    ASSERT_TRUE(ball && ball->object);
    EXPECT_EQ(*ball->object, 0U);
    // The shape's triangles lie within the sphere, by less than a hundredth of its radius.
    EXPECT_NEAR((ball->point_m - eye_m).norm(), (Vector3d(0, 0, 0.05) - eye_m).norm() - 0.05, 5e-4);
    EXPECT_NEAR(ball->depth_m, (pose() * ball->point_m).z(), 1e-12);
    const auto box = pick({0, 0.3, 0.1});
    ASSERT_TRUE(box && box->object);
    EXPECT_EQ(*box->object, 1U);
    EXPECT_LT((box->point_m - Vector3d(0, 0.3, 0.1)).norm(), 1e-6) << "the middle of its top";
    const auto table = pick({-0.2, 0, 0});
    ASSERT_TRUE(table);
    EXPECT_FALSE(table->object);
    EXPECT_LT((table->point_m - Vector3d(-0.2, 0, 0)).norm(), 1e-6);
    // What moves is met where it has gone to, and what is before it first.
    scene.objects[1].translate_m = Vector3d(0, 0, 0.05) + 0.5 * (eye_m - Vector3d(0, 0, 0.05));
    EXPECT_EQ(pick({0, 0, 0.05})->object, 1U);
    scene.surface.present = false;
    EXPECT_FALSE(pick({-0.2, 0, 0}));
}

using AnimatedPicking = ModelTest;

TEST_F(AnimatedPicking, ModelsAreMetAsTheyStandAtThatTime) {
    // A triangle with corners at 0, x and glTF's y (the world's z), which moves by 3 along x in a second.
    GltfBuilder builder = GltfBuilder::triangle();
    const std::size_t input = builder.add<float>({0, 1}, 5126, "SCALAR");
    const std::size_t output = builder.add<float>({0, 0, 0, 3, 0, 0}, 5126, "VEC3");
    builder.root["animations"] = {
        {{"name", "move"},
         {"samplers", {{{"input", input}, {"output", output}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    PickTargets targets;
    targets.add(load(builder));
    const std::vector<Eigen::Matrix4d> placements{Eigen::Matrix4d::Identity()};
    const PixelRay at_rest{Vector3d(0.2, -1, 0.2), Vector3d(0, 1, 0)},
        after_half{Vector3d(1.7, -1, 0.2), Vector3d(0, 1, 0)};
    targets.set_time(0);
    EXPECT_TRUE(targets.first_object(at_rest, placements));
    EXPECT_FALSE(targets.first_object(after_half, placements));
    targets.set_time(0.5);
    EXPECT_FALSE(targets.first_object(at_rest, placements));
    EXPECT_TRUE(targets.first_object(after_half, placements));
}

TEST(Picking, SpheresAreMetAsTheyAreScaledAndPlaced) {
    SphereSet set;
    set.spheres = {{{0, 0, 0}, 1}, {{4, 0, 0}, 0.5}};
    set.update_bounds();
    PickTargets targets;
    targets.add(std::move(set));
    Eigen::Affine3d placement = Eigen::Affine3d::Identity();
    placement.translate(Vector3d(0, 3, 0)).scale(0.1);
    const std::vector<Eigen::Matrix4d> placements = {placement.matrix()};
    const auto first = targets.first_object({Vector3d(0.4, 0, 0), Vector3d::UnitY()}, placements);
    ASSERT_TRUE(first);
    EXPECT_NEAR(first->depth_m, 3 - 0.05, 1e-9);
    EXPECT_FALSE(targets.first_object({Vector3d(0.2, 0, 0), Vector3d::UnitY()}, placements)) << "between the two";
}

}  // namespace
}  // namespace matchlight
