// Circles of confusion of what a frame sees of a box.
#include "compositor/focus.h"

#include <random>

#include <gtest/gtest.h>

#include "render/virtual_layer.h"

namespace matchlight {
namespace {

constexpr double focal_px = 500;
const Focus strong{.coc_scale_px_m = 100, .focus_distance_m = 2};

/// 512 × 384 pixels, seen from the world's origin along its z.
FrameView frame_view() {
    return {.camera_from_world = RigidTransform::Identity(),
            .normalized = {Eigen::Vector2d(-0.512, -0.384), Eigen::Vector2d(0.512, 0.384)},
            .focal_px = focal_px};
}

TEST(Focus, ABoxInTheMiddleOfThePictureCountsAsAWhole) {
    const CocRange range =
        coc_range_of_box(strong, {Eigen::Vector3d(-0.1, -0.1, 1), Eigen::Vector3d(0.1, 0.1, 4)}, frame_view());
    EXPECT_DOUBLE_EQ(range.nearest_px, signed_coc_px(strong, 1));
    EXPECT_DOUBLE_EQ(range.farthest_px, signed_coc_px(strong, 4));
}

TEST(Focus, AFloorThatGoesUnderTheCameraCountsFromWhereItIsSeen) {
    const Eigen::AlignedBox3d floor(Eigen::Vector3d(-3, 1, -1), Eigen::Vector3d(3, 1, 5));
    const CocRange range = coc_range_of_box(strong, floor, frame_view());
    // The lowest point of the opening, 0.1 m below its middle, sees the floor at 1 = 0.384 z + 0.1 (1 − z/2).
    const double nearest_m = 0.9 / (0.384 - 0.05);
    EXPECT_GT(nearest_m, 2);  // beyond the focus: so nothing before it is seen
    EXPECT_DOUBLE_EQ(range.nearest_px, 0);
    EXPECT_DOUBLE_EQ(range.farthest_px, signed_coc_px(strong, 5));
    const Focus farther{.coc_scale_px_m = 100, .focus_distance_m = 4};
    EXPECT_NEAR(coc_range_of_box(farther, floor, frame_view()).nearest_px,
                signed_coc_px(farther, 0.9 / (0.384 - 0.1 / 4)), 1e-9);
}

TEST(Focus, ARoomAroundTheCameraCountsFromTheNearPlane) {
    const Eigen::AlignedBox3d room(Eigen::Vector3d(-2, -2, -2), Eigen::Vector3d(2, 2, 6));
    EXPECT_DOUBLE_EQ(coc_range_of_box(strong, room, frame_view()).nearest_px, signed_coc_px(strong, near_plane_m));
}

TEST(Focus, NoPointThatReachesTheFrameHasAWiderCircle) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    int cut = 0;
    for (int trial = 0; trial < 40; ++trial) {
        FrameView view = frame_view();
        view.camera_from_world.rotate(Eigen::AngleAxisd(unit(random), Eigen::Vector3d(1, 2, 3).normalized()));
        const Eigen::Vector3d low(unit(random) * 4 - 2, unit(random) * 4 - 2, unit(random) * 2);
        const Eigen::AlignedBox3d box(low, low + 2 * Eigen::Vector3d(unit(random), unit(random), unit(random)));
        const CocRange range = coc_range_of_box(strong, box, view);
        double nearest_corner_m = 1e9;
        for (int i = 0; i < 8; ++i)
            nearest_corner_m =
                std::min(nearest_corner_m,
                         (view.camera_from_world * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i))).z());
        if (range.nearest_px > signed_coc_px(strong, std::max(nearest_corner_m, near_plane_m)) + 1e-9) ++cut;
        for (int i = 0; i < 2000; ++i) {
            const Eigen::Vector3d point =
                view.camera_from_world *
                (box.min() + Eigen::Vector3d(unit(random), unit(random), unit(random)).cwiseProduct(box.sizes()));
            if (point.z() < near_plane_m) continue;
            const double coc_px = signed_coc_px(strong, point.z());
            const Eigen::Vector2d seen = point.head<2>() / point.z();
            if (view.normalized.exteriorDistance(seen) > std::abs(coc_px) / 2 / focal_px) continue;
            EXPECT_GE(coc_px, range.nearest_px - 1e-9);
            EXPECT_LE(coc_px, range.farthest_px + 1e-9);
        }
    }
    EXPECT_GT(cut, 5) << "boxes that reach beside the camera were tried";
}

}  // namespace
}  // namespace matchlight
