// Autofocus: depths that are known exactly.
#include "compositor/autofocus.h"

#include <cmath>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Eigen::Vector3d;

/// A camera of 101 × 101 pixels in the world's origin that looks along +y, z up.
Camera small_camera() {
    Camera camera;
    camera.width = camera.height = 101;
    camera.fx = camera.fy = 100;
    camera.cx = camera.cy = 50;
    return camera;
}

RigidTransform looks_along_y() {
    RigidTransform camera_from_world = RigidTransform::Identity();
    camera_from_world.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    return camera_from_world;
}

/// A square of side 1 in the plane y = 0 about the origin, with a hole of half that side where it has one.
FocusObject square(const std::string& name, bool has_hole = false) {
    FocusObject object{.name = name, .triangles = {}, .box_m = {}};
    const auto corner = [](double x, double z) { return Vector3d(x, 0, z); };
    std::vector<Vector3d> positions_m;
    for (const double half : {0.5, 0.25}) {
        for (const auto& place : {corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, half)}) {
            positions_m.push_back(place);
            object.box_m.extend(place);
        }
    }
    std::vector<std::uint32_t> indices = {0, 1, 2, 0, 2, 3};
    if (has_hole) {
        indices.clear();
        for (std::uint32_t side = 0; side < 4; ++side) {
            const std::uint32_t next = (side + 1) % 4;
            indices.insert(indices.end(), {side, next, 4 + next, side, 4 + next, 4 + side});
        }
    }
    object.triangles.add_mesh(positions_m, indices);
    object.triangles.build();
    return object;
}

FocusObject placed(FocusObject object, const Eigen::Affine3d& placement) {
    object.world_from_model = placement.matrix();
    return object;
}

class Autofocus : public testing::Test {
protected:
    std::optional<double> depth(const DepthOfFieldSettings& settings, std::span<const FocusObject> objects,
                                std::optional<double> surface_z_m = {}) {
        return autofocus_depth_m(settings, {camera_, pose_, objects, surface_z_m}, warnings_);
    }
    void SetUp() override { warnings_.set_quiet(true); }

    Camera camera_ = small_camera();
    RigidTransform pose_ = looks_along_y();
    Warnings warnings_;
    const DepthOfFieldSettings middle_{.focus_on = FocusTarget::middle};
};

TEST_F(Autofocus, ADistanceNeedsNone) {
    EXPECT_FALSE(depth({}, {}));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Autofocus, APointsDepthIsAlongTheAxisNotToThePoint) {
    const DepthOfFieldSettings settings{.focus_on = FocusTarget::point, .focus_point_m = {3, 4, -2}};
    EXPECT_DOUBLE_EQ(depth(settings, {}).value(), 4);
}

TEST_F(Autofocus, APointBehindTheCameraIsWarnedOfAndLeftToTheDistance) {
    const DepthOfFieldSettings settings{.focus_on = FocusTarget::point, .focus_point_m = {0, -1, 0}};
    EXPECT_FALSE(depth(settings, {}));
    EXPECT_FALSE(depth(settings, {}));
    ASSERT_EQ(warnings_.entries().size(), 1u);
    EXPECT_EQ(warnings_.entries()[0].count, 2);
}

TEST_F(Autofocus, TheMiddleTakesTheFirstOfAllObjects) {
    std::vector<FocusObject> objects;
    objects.push_back(placed(square("far"), Eigen::Affine3d(Eigen::Translation3d(0, 5, 0))));
    objects.push_back(placed(square("near"), Eigen::Affine3d(Eigen::Translation3d(0.2, 2, 0.3))));
    objects.push_back(placed(square("beside"), Eigen::Affine3d(Eigen::Translation3d(0.6, 1, 0))));
    EXPECT_NEAR(depth(middle_, objects).value(), 2, 1e-12);
    // What moves is met where it stands in the frame.
    objects[1].world_from_model = Eigen::Affine3d(Eigen::Translation3d(0, 7, 0)).matrix();
    EXPECT_NEAR(depth(middle_, objects).value(), 5, 1e-12);
}

TEST_F(Autofocus, ATurnedAndStretchedSquareIsMetWhereTheRayMeetsIt) {
    // Turned by 45° about z and moved by 1 along x: its plane y = 3 + (x − 1) is at 2 where x = 0.
    const Eigen::Affine3d placement = Eigen::Translation3d(1, 3, 0) *
                                      Eigen::AngleAxisd(std::acos(-1) / 4, Vector3d::UnitZ()) *
                                      Eigen::Scaling(8.0, 1.0, 0.5);
    std::vector<FocusObject> objects;
    objects.push_back(placed(square("square"), placement));
    EXPECT_NEAR(depth(middle_, objects).value(), 2, 1e-12);
}

TEST_F(Autofocus, TheMiddleTakesTheSurfaceWhereItIsNearer) {
    // Looking down by 45° from the height 1.
    RigidTransform down = RigidTransform::Identity();
    const double s = std::sqrt(0.5);
    down.linear() << 1, 0, 0, 0, -s, -s, 0, s, -s;
    down.translation() = down.linear() * Vector3d(0, 0, -1);
    pose_ = down;
    EXPECT_NEAR(depth(middle_, {}, 0.0).value(), std::sqrt(2), 1e-12);
    EXPECT_NEAR(depth(middle_, {}, 0.5).value(), std::sqrt(0.5), 1e-12);
    EXPECT_FALSE(depth(middle_, {}, 2.0));  // above the camera, which looks down
    std::vector<FocusObject> objects;
    objects.push_back(placed(square("square"), Eigen::Affine3d(Eigen::Translation3d(0, 0.5, 0.5))));
    EXPECT_NEAR(depth(middle_, objects, 0.0).value(), std::sqrt(0.5), 1e-12);
}

TEST_F(Autofocus, AnEmptyMiddleIsWarnedOf) {
    std::vector<FocusObject> objects;
    objects.push_back(placed(square("ring", true), Eigen::Affine3d(Eigen::Translation3d(0, 2, 0))));
    objects.push_back(placed(square("behind"), Eigen::Affine3d(Eigen::Translation3d(0, -2, 0))));
    EXPECT_FALSE(depth(middle_, objects));
    EXPECT_EQ(warnings_.total(), 1);
}

TEST_F(Autofocus, TheMiddlesRayGoesThroughTheLens) {
    camera_.cx = 30;  // the middle of the picture is 0.2 to the right of the axis
    const Eigen::Affine3d placement =
        Eigen::Translation3d(0, 3, 0) * Eigen::AngleAxisd(std::acos(-1) / 4, Vector3d::UnitZ()) * Eigen::Scaling(8.0);
    std::vector<FocusObject> objects;
    objects.push_back(placed(square("square"), placement));
    // y = 3 + x along x = 0.2 y.
    EXPECT_NEAR(depth(middle_, objects).value(), 3 / 0.8, 1e-12);
}

TEST_F(Autofocus, AnObjectIsFocusedOnItsFrontWhateverStandsBeforeIt) {
    std::vector<FocusObject> objects;
    objects.push_back(placed(square("screen"), Eigen::Affine3d(Eigen::Translation3d(1, 1, 0))));
    objects.push_back(placed(square("wanted"), Eigen::Affine3d(Eigen::Translation3d(3, 3, 0))));
    objects.push_back(placed(square("ring", true), Eigen::Affine3d(Eigen::Translation3d(0, 4, 1))));
    const auto on = [](const std::string& name) {
        return DepthOfFieldSettings{.focus_on = FocusTarget::object, .focus_object = name};
    };
    EXPECT_NEAR(depth(on("wanted"), objects).value(), 3, 1e-12);
    EXPECT_NEAR(depth(on("ring"), objects).value(), 4, 1e-12);  // through its hole: its centre
    EXPECT_TRUE(warnings_.empty());
    objects[1].world_from_model = Eigen::Affine3d(Eigen::Translation3d(3, -3, 0)).matrix();
    EXPECT_FALSE(depth(on("wanted"), objects));
    EXPECT_EQ(warnings_.total(), 1);
}

/// A box whose front is nearer than its middle.
TEST_F(Autofocus, TheFrontOfASolidCounts) {
    FocusObject box{.name = "box", .triangles = {}, .box_m = {}};
    std::vector<Vector3d> positions_m;
    for (int i = 0; i < 8; ++i) {
        positions_m.emplace_back(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
        box.box_m.extend(positions_m.back());
    }
    // Front (y = −½) and back.
    box.triangles.add_mesh(positions_m, std::vector<std::uint32_t>{0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6});
    box.triangles.build();
    box.world_from_model = Eigen::Affine3d(Eigen::Translation3d(0, 4, 0)).matrix();
    std::vector<FocusObject> objects;
    objects.push_back(std::move(box));
    EXPECT_NEAR(depth({.focus_on = FocusTarget::object, .focus_object = "box"}, objects).value(), 3.5, 1e-12);
}

}  // namespace
}  // namespace matchlight
