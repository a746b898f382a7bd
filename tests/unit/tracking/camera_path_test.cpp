// The path over a clip: flips, gaps, ids seen twice.
#include "tracking/camera_path.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "synthetic_observations.h"
#include "tracking/branch_choice.h"

namespace matchlight {
namespace {

using test::orbit_pose;
using test::ordinary_camera;

constexpr double frame_s = 1 / 24.0;

double angle_deg(const RigidTransform& a, const RigidTransform& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / std::numbers::pi;
}

std::vector<RigTag> given(const std::vector<test::PlacedTag>& rig) {
    std::vector<RigTag> tags;
    for (const auto& tag : rig) tags.push_back({tag.id, tag.size_m, tag.world_from_tag});
    return tags;
}

std::map<int, RigidTransform> places(const std::vector<test::PlacedTag>& rig) {
    std::map<int, RigidTransform> result;
    for (const auto& tag : rig) result[tag.id] = tag.world_from_tag;
    return result;
}

RigidTransform moving_pose(int frame) {
    return orbit_pose(0.5 + 0.002 * frame, 40 + 0.3 * frame, 1.5 * frame, 0.5 * frame);
}

std::vector<FrameObservations> moving_clip(const std::vector<test::PlacedTag>& rig, int frames, double sigma_px) {
    const Camera camera = ordinary_camera();
    std::mt19937 random(5);
    std::vector<FrameObservations> clip;
    for (int f = 0; f < frames; ++f) {
        FrameObservations& frame = clip.emplace_back();
        frame.frame = f;
        frame.time_s = f * frame_s;
        for (const auto& tag : rig) {
            frame.tags.push_back(test::noisy(test::seen_tag(camera, moving_pose(f), tag), camera, sigma_px, random));
        }
    }
    return clip;
}

TEST(BranchChoice, KeepsASmallTagFromFlipping) {
    // NUMERICS: 25 px wide, tilted by 10°, 0.3 px of corner noise: the better-looking face is the wrong one in a third
    // of the frames. The camera circles slowly, so the wrong face would have to jump.
    const Camera camera = ordinary_camera();
    const test::PlacedTag tag{0, 0.04, RigidTransform::Identity()};
    std::mt19937 random(11);
    std::vector<PoseCandidates> candidates;
    std::vector<RigidTransform> truth;
    int wrong_alone = 0;
    constexpr int frames = 120;
    for (int f = 0; f < frames; ++f) {
        truth.push_back(orbit_pose(1.0, 14 + 4 * std::sin(0.05 * f), 1.2 * f, 0));
        const TagObservation seen = test::noisy(test::seen_tag(camera, truth.back(), tag), camera, 0.3, random);
        candidates.push_back({f * frame_s, planar_poses(seen, tag.size_m)});
        ASSERT_FALSE(candidates.back().poses.empty());
        if (angle_deg(candidates.back().poses[0].camera_from_world, truth.back()) > 14) ++wrong_alone;
    }
    const auto chosen = choose_branches(candidates, Eigen::Vector3d::Zero());
    int wrong = 0;
    for (std::size_t f = 0; f < candidates.size(); ++f) {
        ASSERT_TRUE(chosen[f]);
        const auto& poses = candidates[f].poses;
        const double error = angle_deg(poses[*chosen[f]].camera_from_world, truth[f]);
        const double other = poses.size() > 1 ? angle_deg(poses[1 - *chosen[f]].camera_from_world, truth[f]) : 180;
        if (error > other) ++wrong;
    }
    EXPECT_GT(wrong_alone, frames / 10) << "the case is too easy to prove anything";
    EXPECT_LE(wrong, frames / 50);
}

TEST(BranchChoice, AFastPanIsNoFlip) {
    // Two frames between which the camera turned in place by 25°: the pose goes on, whatever the cost says.
    const RigidTransform pose = orbit_pose(0.8, 20, 0, 0);
    RigidTransform panned = pose;
    panned = RigidTransform(Eigen::AngleAxisd(25 * std::numbers::pi / 180, Eigen::Vector3d::UnitY())) * pose;
    const RigidTransform flipped = orbit_pose(0.8, -20, 0, 0);
    const auto candidate = [](const RigidTransform& p, double cost) {
        CameraPose c;
        c.camera_from_world = p;
        c.cost = cost;
        return c;
    };
    const std::vector<PoseCandidates> frames{
        {0, {candidate(pose, 1), candidate(flipped, 60)}},
        {frame_s, {candidate(flipped, 1.0), candidate(panned, 1.5)}},
    };
    const auto chosen = choose_branches(frames, Eigen::Vector3d::Zero());
    EXPECT_EQ(chosen[0], 0u);
    EXPECT_EQ(chosen[1], 1u);
}

TEST(CameraPath, FollowsTheCamera) {
    const auto rig = test::four_tags();
    const auto clip = moving_clip(rig, 30, 0.05);
    const CameraPath path = solve_path(given(rig), places(rig), clip, ordinary_camera());
    ASSERT_EQ(path.frames.size(), 30u);
    EXPECT_EQ(path.missing, 0);
    for (const PathFrame& frame : path.frames) {
        ASSERT_TRUE(frame.pose);
        const RigidTransform truth = moving_pose(static_cast<int>(frame.frame));
        EXPECT_LT(angle_deg(frame.pose->camera_from_world, truth), 0.05);
        EXPECT_EQ(frame.tags, (std::vector<int>{0, 1, 2, 3}));
        EXPECT_GT(frame.confidence, 0.9);
    }
}

TEST(CameraPath, BridgesShortGapsAndLeavesLongOnes) {
    const auto rig = test::four_tags();
    auto clip = moving_clip(rig, 60, 0.02);
    for (int f = 10; f < 14; ++f) clip[static_cast<std::size_t>(f)].tags.clear();  // 4 frames
    for (int f = 30; f < 42; ++f) clip[static_cast<std::size_t>(f)].tags.clear();  // half a second
    for (int f = 57; f < 60; ++f) clip[static_cast<std::size_t>(f)].tags.clear();  // nothing follows
    const CameraPath path = solve_path(given(rig), places(rig), clip, ordinary_camera());
    EXPECT_EQ(path.bridged, 4);
    EXPECT_EQ(path.missing, 12 + 3);
    const Camera camera = ordinary_camera();
    for (int f = 10; f < 14; ++f) {
        const PathFrame& frame = path.frames[static_cast<std::size_t>(f)];
        ASSERT_TRUE(frame.pose);
        EXPECT_TRUE(frame.bridged);
        // The path is smooth: the cubic follows it to a fraction of a pixel.
        const Eigen::Vector3d point(0.02, 0.03, 0.04);
        const double error_px = (camera.pixel_from_camera(frame.pose->camera_from_world * point) -
                                 camera.pixel_from_camera(moving_pose(f) * point))
                                    .norm();
        EXPECT_LT(error_px, 0.5);
        EXPECT_LT(frame.confidence, path.frames[9].confidence);
        EXPECT_GT(frame.pose->covariance.trace(), path.frames[9].pose->covariance.trace());
    }
    for (int f = 30; f < 42; ++f) EXPECT_FALSE(path.frames[static_cast<std::size_t>(f)].pose);
}

TEST(CameraPath, OfAnIdSeenTwiceTheOneThatFitsIsKept) {
    const auto rig = test::four_tags();
    auto clip = moving_clip(rig, 5, 0.05);
    for (FrameObservations& frame : clip) {
        TagObservation copy = frame.tags[1];  // a second print of tag 1 elsewhere, listed first
        copy.corners_normalized.colwise() += Eigen::Vector2d(0.2, 0.1);
        copy.corners_px.colwise() += Eigen::Vector2d(124, 62);
        frame.tags.insert(frame.tags.begin() + 1, copy);
    }
    const CameraPath path = solve_path(given(rig), places(rig), clip, ordinary_camera());
    for (const PathFrame& frame : path.frames) {
        ASSERT_TRUE(frame.pose);
        EXPECT_TRUE(frame.seen_twice);
        EXPECT_LT(angle_deg(frame.pose->camera_from_world, moving_pose(static_cast<int>(frame.frame))), 0.05);
        EXPECT_LT(frame.reprojection_px, 0.2);
    }
}

TEST(CameraPath, ATagThatWasMovedIsLeftOut) {
    const auto rig = test::four_tags();
    auto moved = rig;
    moved[2].world_from_tag.translation() += Eigen::Vector3d(0.01, 0, 0);  // the sheet slid by a centimetre
    const CameraPath path = solve_path(given(rig), places(rig), moving_clip(moved, 5, 0.05), ordinary_camera());
    for (const PathFrame& frame : path.frames) {
        ASSERT_TRUE(frame.pose);
        EXPECT_TRUE(frame.outvoted);
        EXPECT_EQ(frame.tags, (std::vector<int>{0, 1, 3}));
        EXPECT_LT(angle_deg(frame.pose->camera_from_world, moving_pose(static_cast<int>(frame.frame))), 0.05);
        EXPECT_LT(frame.reprojection_px, 0.15);
    }
}

TEST(CameraPath, ConfidenceFallsWithSizeAndTilt) {
    const Camera camera = ordinary_camera();
    const auto confidence_of = [&](double size_m, double tilt_deg, bool& small, bool& grazing) {
        const test::PlacedTag tag{0, size_m, RigidTransform::Identity()};
        FrameObservations frame;
        std::mt19937 random(1);
        frame.tags = {test::noisy(test::seen_tag(camera, orbit_pose(0.6, tilt_deg, 10, 0), tag), camera, 0.1, random)};
        const CameraPath path = solve_path(given({tag}), places({tag}), {frame}, camera);
        small = path.frames[0].small;
        grazing = path.frames[0].grazing;
        return path.frames[0].confidence;
    };
    bool small = false, grazing = false;
    // One tag of 100 px leaves about 0.4 px of doubt at the height of its own side.
    EXPECT_GT(confidence_of(0.1, 30, small, grazing), 0.75);
    EXPECT_FALSE(small || grazing);
    EXPECT_LT(confidence_of(0.02, 30, small, grazing), 0.5);  // 20 px
    EXPECT_TRUE(small);
    EXPECT_LT(confidence_of(0.1, 80, small, grazing), 0.5);
    EXPECT_TRUE(grazing);
}

}  // namespace
}  // namespace matchlight
