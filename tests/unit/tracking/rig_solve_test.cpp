// Places of tags from synthetic clips with known answers.
#include "tracking/rig_solve.h"

#include <algorithm>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "synthetic_observations.h"

namespace matchlight {
namespace {

using test::orbit_pose;
using test::ordinary_camera;

/// A camera that circles the rig by a third of a turn. `shows(frame, id)` says which tags are in view.
template <class Shows>
std::vector<FrameObservations> clip_of(const std::vector<test::PlacedTag>& rig, int frames, double sigma_px,
                                       Shows shows) {
    const Camera camera = ordinary_camera();
    std::mt19937 random(3);
    std::vector<FrameObservations> clip;
    for (int f = 0; f < frames; ++f) {
        const RigidTransform pose =
            orbit_pose(0.6, 45 + 8 * std::sin(0.3 * f), 120.0 * f / frames, 3 * std::cos(0.2 * f));
        FrameObservations& frame = clip.emplace_back();
        frame.frame = f;
        frame.time_s = f / 24.0;
        for (const auto& tag : rig) {
            if (!shows(f, tag.id)) continue;
            frame.tags.push_back(test::noisy(test::seen_tag(camera, pose, tag), camera, sigma_px, random));
        }
    }
    return clip;
}

std::vector<RigTag> asked(const std::vector<test::PlacedTag>& rig, const std::vector<int>& given) {
    std::vector<RigTag> tags;
    for (const auto& tag : rig) {
        RigTag& wanted = tags.emplace_back();
        wanted.id = tag.id;
        wanted.size_m = tag.size_m;
        if (std::ranges::find(given, tag.id) != given.end()) wanted.world_from_tag = tag.world_from_tag;
    }
    return tags;
}

void expect_place(const RigSolution& solution, const test::PlacedTag& tag, double metres, double degrees) {
    ASSERT_TRUE(solution.world_from_tag.contains(tag.id));
    const RigidTransform error = tag.world_from_tag.inverse() * solution.world_from_tag.at(tag.id);
    EXPECT_LT(error.translation().norm(), metres) << "tag " << tag.id;
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle() * 180 / std::numbers::pi, degrees) << "tag " << tag.id;
}

TEST(RigSolve, FindsTheOthersFromOneGivenPlace) {
    const auto rig = test::four_tags();
    const auto clip = clip_of(rig, 60, 0.1, [](int, int) { return true; });
    const RigSolution solution = solve_rig(asked(rig, {0}), clip);
    EXPECT_TRUE(solution.unplaced.empty());
    // 0.1 px at 0.6 m and f = 620 px is 0.1 mm; sixty views average it.
    for (const auto& tag : rig) expect_place(solution, tag, 1e-4, 0.1);
    EXPECT_NEAR(solution.rms, 1, 0.3);
}

TEST(RigSolve, WithoutAnyPlaceTheLowestIdSeenIsTheOrigin) {
    const auto rig = test::four_tags();
    const auto clip = clip_of(rig, 40, 0.05, [](int, int id) { return id != 0; });
    const RigSolution solution = solve_rig(asked(rig, {}), clip);
    ASSERT_TRUE(solution.world_from_tag.contains(1));
    EXPECT_TRUE(solution.world_from_tag.at(1).isApprox(RigidTransform::Identity()));
    EXPECT_FALSE(solution.world_from_tag.contains(0));
    test::PlacedTag relative = rig[2];
    relative.world_from_tag = rig[1].world_from_tag.inverse() * rig[2].world_from_tag;
    // How tag 1 itself lies carries over to 0.27 m away.
    expect_place(solution, relative, 2e-4, 0.1);
}

TEST(RigSolve, ChainsTagsThatAreNeverAllInView) {
    const auto rig = test::four_tags();
    const auto clip =
        clip_of(rig, 90, 0.05, [](int frame, int id) { return id == frame / 30 || id == frame / 30 + 1; });
    const RigSolution solution = solve_rig(asked(rig, {0}), clip);
    EXPECT_TRUE(solution.unplaced.empty());
    for (const auto& tag : rig) expect_place(solution, tag, 1e-3, 0.5);
}

TEST(RigSolve, SaysWhichTagCannotBePlaced) {
    const auto rig = test::four_tags();
    const auto clip = clip_of(rig, 40, 0.05, [](int frame, int id) { return id == 3 ? frame >= 30 : frame < 30; });
    const RigSolution solution = solve_rig(asked(rig, {0}), clip);
    EXPECT_EQ(solution.unplaced, std::vector<int>{3});
    EXPECT_FALSE(solution.world_from_tag.contains(3));
}

TEST(RigSolve, SmallTagsThatFlipAreVotedUpright) {
    // 20 px wide and 0.3 px of noise: single views often prefer the wrong face.
    auto rig = test::four_tags();
    for (auto& tag : rig) tag.size_m = tag.id == 0 ? 0.08 : 0.02;
    const auto clip = clip_of(rig, 80, 0.3, [](int, int) { return true; });
    const RigSolution solution = solve_rig(asked(rig, {0}), clip);
    for (const auto& tag : rig) expect_place(solution, tag, 1e-3, 3);
}

TEST(RigSolve, HeldPlacesStay) {
    const auto rig = test::four_tags();
    const auto clip = clip_of(rig, 20, 0.1, [](int, int) { return true; });
    const RigSolution solution = solve_rig(asked(rig, {0, 1, 2}), clip);
    for (const int id : {0, 1, 2}) {
        EXPECT_TRUE(solution.world_from_tag.at(id).isApprox(rig[static_cast<std::size_t>(id)].world_from_tag, 0));
    }
    expect_place(solution, rig[3], 2e-4, 0.2);
}

}  // namespace
}  // namespace matchlight
