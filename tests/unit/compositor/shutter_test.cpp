// Poses and times while the shutter is open.
#include "compositor/shutter.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

/// Poses of a camera whose place is a parabola in time, and which turns at an even pace.
RigidTransform pose_at(double frame) {
    RigidTransform world_from_camera = RigidTransform::Identity();
    world_from_camera.linear() =
        Eigen::AngleAxisd(0.3 + 0.2 * frame, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    world_from_camera.translation() = Eigen::Vector3d(1 + frame, 0.1 * frame * frame, 3 - 2 * frame);
    return world_from_camera.inverse();
}

Solve solve_with(const std::vector<std::int64_t>& posed) {
    Solve solve;
    for (std::int64_t i = 0; i < 4; ++i) {
        SolvedFrame frame;
        frame.frame = i;
        frame.time_s = 0.04 * static_cast<double>(i);
        if (std::ranges::find(posed, i) != posed.end()) frame.camera_from_world = pose_at(static_cast<double>(i));
        solve.frames.push_back(frame);
    }
    return solve;
}

TEST(Shutter, GoesOnTheParabolaThroughThreePoses) {
    const Solve solve = solve_with({0, 1, 2, 3});
    const FrameShutter shutter(solve, solve.frames[1], 0.5, 1);
    EXPECT_TRUE(shutter.knows_motion());
    EXPECT_TRUE(shutter.camera_from_world(0).isApprox(pose_at(1), 1e-12));
    for (double time = -1; time <= 1; time += 0.125) {
        EXPECT_TRUE(shutter.camera_from_world(time).isApprox(pose_at(1 + time), 1e-9)) << time;
        EXPECT_NEAR(shutter.time(time).time_s, 0.04 * (1 + time), 1e-12) << "time is the clip's, not the fallback";
        EXPECT_EQ(shutter.time(time).frame, 1 + time);
    }
}

TEST(Shutter, TakesTheOneNeighbourThatHasAPose) {
    for (const std::int64_t neighbour : {0, 2}) {
        const Solve solve = solve_with({neighbour, 1});
        const FrameShutter shutter(solve, solve.frames[1], 0.5, 1);
        ASSERT_TRUE(shutter.knows_motion());
        const auto step = static_cast<double>(neighbour - 1);
        EXPECT_TRUE(shutter.camera_from_world(step).isApprox(pose_at(static_cast<double>(neighbour)), 1e-9));
        const Eigen::Vector3d middle = shutter.camera_from_world(step / 2).inverse().translation();
        EXPECT_TRUE(middle.isApprox(
            (pose_at(1).inverse().translation() + pose_at(static_cast<double>(neighbour)).inverse().translation()) / 2,
            1e-12));
    }
}

TEST(Shutter, StandsStillWithoutNeighbours) {
    const Solve solve = solve_with({1, 3});
    const FrameShutter shutter(solve, solve.frames[1], 0.5, 1);
    EXPECT_FALSE(shutter.knows_motion());
    EXPECT_TRUE(shutter.camera_from_world(0.4).isApprox(pose_at(1), 1e-12));
}

TEST(Shutter, TimesAreEvenAndTheirMeanIsTheMiddle) {
    for (const bool shuffled : {false, true}) {
        for (const int count : {1, 2, 7, 64}) {
            std::vector<double> times = shutter_times(count, shuffled);
            if (shuffled && count > 2) {
                EXPECT_FALSE(std::ranges::is_sorted(times));
            }
            std::ranges::sort(times);
            for (int i = 0; i < count; ++i) {
                EXPECT_NEAR(times[static_cast<std::size_t>(i)], (i + 0.5) / count - 0.5, 1e-12);
            }
        }
    }
}

TEST(Shutter, ShuffledTimesAreEvenOverEveryPartOfTheLens) {
    // Lens points go outwards evenly in area: any quarter of them in a row is a ring, and sees all of the shutter.
    const std::vector<double> times = shutter_times(64, true);
    for (std::size_t ring = 0; ring < 4; ++ring) {
        double mean = 0;
        for (std::size_t i = 0; i < 16; ++i) mean += times[16 * ring + i] / 16;
        EXPECT_NEAR(mean, 0, 0.05) << ring;
    }
}

TEST(Shutter, ItsShareIsTheSettingsElseTheSolvesElseTheUsual) {
    Warnings warnings;
    warnings.set_quiet(true);
    Solve solve = solve_with({0, 1, 2, 3});
    const SolvedFrame& frame = solve.frames[1];
    EXPECT_EQ(shutter_share({}, solve, frame, std::nullopt, warnings), std::nullopt);
    EXPECT_EQ(warnings.total(), 1);
    EXPECT_EQ(shutter_share({}, solve, frame, usual_shutter, warnings), 0.5);
    solve.frames[3].shutter_fraction = 0.25;
    EXPECT_EQ(shutter_share({}, solve, frame, usual_shutter, warnings), 0.25) << "the nearest that knows";
    EXPECT_EQ(shutter_share({.shutter = 0.9}, solve, frame, std::nullopt, warnings), 0.9);
    EXPECT_EQ(warnings.total(), 1);
}

TEST(Shutter, SettingsHaveRanges) {
    EXPECT_THROW((MotionBlurSettings{.shutter = 1.01}.check()), std::invalid_argument);
    EXPECT_THROW((MotionBlurSettings{.shutter = std::nan("")}.check()), std::invalid_argument);
    EXPECT_THROW((MotionBlurSettings{.sub_frames = 0}.check()), std::invalid_argument);
    EXPECT_NO_THROW((MotionBlurSettings{.shutter = 1, .sub_frames = 1}.check()));
}

}  // namespace
}  // namespace matchlight
