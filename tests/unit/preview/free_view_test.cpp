// Where a hand leads the camera.
#include "preview/free_view.h"

#include <numbers>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Eigen::Vector3d;

CameraView from_the_front() {
    return {.eye_m = {0.1, -0.8, 0.6}, .target_m = {0.1, 0, 0}};
}

TEST(FreeView, BeginsWhereTheCameraStands) {
    const RigidTransform pose = pose_of_view(from_the_front());
    const CameraView view = view_of_pose(pose, 1);
    EXPECT_TRUE(view.eye_m.isApprox(from_the_front().eye_m, 1e-12));
    EXPECT_TRUE(view.target_m.isApprox(from_the_front().target_m, 1e-12));
    EXPECT_TRUE(pose_of_view(view).isApprox(pose, 1e-12));
}

TEST(FreeView, TurnsAboutWhatItLooksAt) {
    // What is turned to the left shows its right side: the camera goes to the right, and a quarter of a turn is enough.
    const CameraView view = turned(from_the_front(), -std::numbers::pi / 2, 0);
    EXPECT_TRUE(view.eye_m.isApprox(Vector3d(0.9, 0, 0.6), 1e-12)) << view.eye_m.transpose();
    EXPECT_EQ(view.target_m, from_the_front().target_m);
    EXPECT_NEAR(turned(view, 0, 10).eye_m.z(), 1, 1e-3) << "all but straight above, and no further";
    EXPECT_TRUE(pose_of_view(turned(view, 0, 10)).matrix().allFinite());
}

TEST(FreeView, ShiftsInThePicturesDirections) {
    const CameraView view = shifted(from_the_front(), 0.2, 0.5);
    EXPECT_TRUE((view.eye_m - from_the_front().eye_m).isApprox(Vector3d(0.2, 0.3, 0.4), 1e-12));
    EXPECT_TRUE((view.target_m - from_the_front().target_m).isApprox(Vector3d(0.2, 0.3, 0.4), 1e-12));
}

TEST(FreeView, GoesNearerAndNeverThere) {
    CameraView view = at_distance(from_the_front(), 0.5);
    EXPECT_TRUE(view.eye_m.isApprox(Vector3d(0.1, -0.4, 0.3), 1e-12));
    for (int i = 0; i < 100; ++i) view = at_distance(view, 0.5);
    EXPECT_GT((view.eye_m - view.target_m).norm(), 0);
}

}  // namespace
}  // namespace matchlight
