// Where the picture of the real surface lies, from cameras with known views of its plane.
#include "compositor/plane_grid.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

/// 640 × 480, 500 pixels of focal length, a tag at the origin.
Solve solve_with_tag() {
    Solve solve;
    solve.camera = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 319.5, .cy = 239.5, .distortion = {}};
    solve.rig.push_back({.id = 0, .size_m = 0.08});
    return solve;
}

PlaneGrid grid_of(const Solve& solve, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& target_m, int most_texels) {
    const RigidTransform camera = camera_looking_along(eye_m, (target_m - eye_m).normalized());
    return plan_plane_grid({camera}, solve, make_lens_map(solve.camera), 0, most_texels);
}

TEST(PlaneGrid, from_above_texels_are_pixels_and_all_of_the_frame_is_in) {
    const PlaneGrid grid = grid_of(solve_with_tag(), {0, 0, 1}, {0, 0, 0}, 2048);
    EXPECT_NEAR(grid.texel_m, 1.0 / 500, 1e-6);
    EXPECT_EQ(grid.columns, 640);
    EXPECT_EQ(grid.rows, 512);  // the next multiple of 64
    EXPECT_NEAR(grid.rectangle_m.min().x(), -0.639, 1e-4);
    EXPECT_NEAR(grid.rectangle_m.min().y(), -0.479, 1e-4);
    EXPECT_NEAR(grid.rectangle_m.sizes().y(), 512.0 / 500, 1e-6);
}

TEST(PlaneGrid, towards_the_horizon_it_ends) {
    const PlaneGrid grid = grid_of(solve_with_tag(), {0, -1, 0.3}, {0, 0, 0.1}, 2048);
    ASSERT_GT(grid.columns, 0);
    // Where a pixel is 16 texels long: at height h, d²/(h f) = 16 · 1.04 / f, d about 2.2 m from the eye.
    EXPECT_NEAR(grid.rectangle_m.max().y(), -1 + std::sqrt(16 * 1.04 * 0.3), 0.4);
    EXPECT_LE(grid.columns, 2048);
    EXPECT_LE(grid.rows, 2048);
}

TEST(PlaneGrid, where_there_is_too_much_the_rig_is_in_the_middle) {
    const PlaneGrid grid = grid_of(solve_with_tag(), {0, 0, 1}, {0, 0, 0}, 128);
    EXPECT_EQ(grid.columns, 128);
    EXPECT_EQ(grid.rows, 128);
    EXPECT_NEAR(grid.texel_m, 2.0 / 500, 1e-6);
    EXPECT_NEAR(grid.rectangle_m.center().norm(), 0, 1e-3);
}

TEST(PlaneGrid, from_below_or_without_frames_there_is_none) {
    EXPECT_EQ(grid_of(solve_with_tag(), {0, 0, -1}, {0, 0.1, 0}, 2048).columns, 0);
    EXPECT_EQ(grid_of(solve_with_tag(), {0, 0, 1}, {0, 1, 2}, 2048).columns, 0);
    const Solve solve = solve_with_tag();
    EXPECT_EQ(plan_plane_grid({}, solve, make_lens_map(solve.camera), 0, 2048).columns, 0);
}

}  // namespace
}  // namespace matchlight
