// Drags of handles, where what they make of an object is known.
#include "preview/handles.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Eigen::Vector3d;

/// From half a metre away, towards a point.
PixelRay ray_to(const Vector3d& point_m) {
    const Vector3d eye_m(0.1, -0.5, 0.4);
    return {eye_m, point_m - eye_m};
}

/// Of an object on a tag that stands upright: its plane is x = 0.2 of the world.
Handles upright() {
    Handles handles;
    handles.world_from_parent.translation() = Vector3d(0.2, 0, 0);
    handles.world_from_parent.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).toRotationMatrix();
    handles.centre_m = handles.world_from_parent * Vector3d(0.01, 0.02, 0);
    handles.radius_m = 0.05;
    return handles;
}

Placing placed() {
    return {.translate_m = {0.01, 0.02, 0}, .rotate_deg = {0, 0, 170}, .scale = {0.1, 0.1, 0.2}};
}

TEST(Handles, AreOnThePlaneAndAboveIt) {
    const Handles handles = upright();
    for (const Vector3d& point_m : handles.ring(12)) {
        EXPECT_NEAR(handles.plane().signedDistance(point_m), 0, 1e-15);
        EXPECT_NEAR((point_m - handles.centre_m).norm(), 0.05, 1e-15);
    }
    EXPECT_EQ(handles.ring(12).front(), handles.ring(12).back());
    EXPECT_NEAR(handles.plane().signedDistance(handles.size_knob()), 0, 1e-15);
    EXPECT_NEAR(handles.plane().signedDistance(handles.lift_knob()), 0.05, 1e-15);
}

TEST(Handles, MovingKeepsWhatWasGrabbedUnderThePointer) {
    const Handles handles = upright();
    // Grabbed above the plane, as objects are.
    const Vector3d grabbed_m = handles.world_from_parent * Vector3d(0.03, 0.0, 0.04);
    const auto drag = HandleDrag::begin({Grip::move, grabbed_m}, placed(), handles, ray_to(grabbed_m));
    ASSERT_TRUE(drag);
    const auto moved = drag->to(ray_to(handles.world_from_parent * Vector3d(0.05, 0.03, 0.04)));
    ASSERT_TRUE(moved);
    // Hundredths of a millimetre are what is written.
    EXPECT_TRUE(moved->translate_m.isApprox(Vector3d(0.03, 0.05, 0), 1e-12)) << moved->translate_m.transpose();
    EXPECT_EQ(moved->scale, placed().scale);
    EXPECT_EQ(moved->rotate_deg, placed().rotate_deg);
}

TEST(Handles, TurningAddsTheAngleAboutThePlanesNormal) {
    const Handles handles = upright();
    const auto on_ring = [&](double deg) {
        const double angle = deg * std::numbers::pi / 180;
        return ray_to(handles.world_from_parent *
                      Vector3d(0.01 + 0.05 * std::cos(angle), 0.02 + 0.05 * std::sin(angle), 0));
    };
    const auto drag = HandleDrag::begin(Grab{.grip = Grip::turn}, placed(), handles, on_ring(30));
    ASSERT_TRUE(drag);
    EXPECT_NEAR(drag->to(on_ring(35.5))->rotate_deg.z(), 175.5, 1e-9);
    EXPECT_NEAR(drag->to(on_ring(55))->rotate_deg.z(), -165, 1e-9) << "the shorter way to say 195";
}

TEST(Handles, ScalingIsByTheDistanceFromTheMiddle) {
    const Handles handles = upright();
    const auto drag = HandleDrag::begin(Grab{.grip = Grip::size}, placed(), handles, ray_to(handles.size_knob()));
    ASSERT_TRUE(drag);
    const Vector3d out_m = handles.centre_m + 2.5 * (handles.size_knob() - handles.centre_m);
    EXPECT_TRUE(drag->to(ray_to(out_m))->scale.isApprox(Vector3d(0.25, 0.25, 0.5), 1e-12));
    const auto gone = drag->to(ray_to(handles.centre_m));
    ASSERT_TRUE(gone);
    EXPECT_GT(gone->scale.minCoeff(), 0) << "nothing is scaled away";
}

TEST(Handles, LiftingFollowsTheNormal) {
    const Handles handles = upright();
    const auto drag = HandleDrag::begin(Grab{.grip = Grip::lift}, placed(), handles, ray_to(handles.lift_knob()));
    ASSERT_TRUE(drag);
    const auto lifted = drag->to(ray_to(handles.lift_knob() + 0.07 * handles.up()));
    ASSERT_TRUE(lifted);
    EXPECT_TRUE(lifted->translate_m.isApprox(Vector3d(0.01, 0.02, 0.07), 1e-12)) << lifted->translate_m.transpose();
}

TEST(Handles, LeadNowhereWhereThePlaneIsSeenFromItsEdge) {
    const Handles handles = upright();
    const PixelRay along{handles.centre_m - Vector3d(0.3, 0, 0), Vector3d::UnitX()};
    const PixelRay beside{handles.centre_m + Vector3d(0, 0, 0.4), -Vector3d::UnitZ()};
    EXPECT_FALSE(HandleDrag::begin(Grab{.grip = Grip::turn}, placed(), handles, beside));
    EXPECT_FALSE(HandleDrag::begin(Grab{.grip = Grip::lift}, placed(), handles, along));
}

}  // namespace
}  // namespace matchlight
