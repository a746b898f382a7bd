// Scores of solves with known errors, tags that agree or do not, other libraries' poses of exact corners, and the
// files.
#include "report/track_truth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "report/pose_peers.h"
#include "report/tag_agreement.h"
#include "report/tag_pose_trial.h"
#include "report/track_peers.h"
#include "report/track_text.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

Camera camera_800() {
    Camera camera;
    camera.width = 640, camera.height = 480;
    camera.fx = camera.fy = 800, camera.cx = 320, camera.cy = 240;
    return camera;
}

RigidTransform pose_at(double x_m) {
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    pose.linear() = pose.linear() * rotation_from_degrees({35, 0, 10});
    pose.translation() = Eigen::Vector3d(x_m, 0, 0.8);
    return pose;
}

TrackTruth truth_of(int frames, double step_m) {
    TrackTruth truth;
    for (int f = 0; f < frames; ++f) truth.frames[f] = {pose_at(step_m * f), 0.5, 0.8};
    truth.white_balance = {1.1, 1, 0.9};
    truth.shutter_fraction = 0.5;
    truth.coc_scale_px_m = 8;
    return truth;
}

TEST(TrackTruth, KnownErrorsComeOut) {
    // Frames 0..5; 1 px beside at 0.8 m is 1 mm. Frame 3 is lost, frame 5 was not tracked.
    const TrackTruth truth = truth_of(6, 0.001);
    std::vector<SolvedFrame> frames;
    for (int f = 0; f < 5; ++f) {
        SolvedFrame& frame = frames.emplace_back();
        frame.frame = f;
        if (f == 3) continue;
        frame.camera_from_world = pose_at(0.001 * f);
        if (f == 4) frame.camera_from_world->pretranslate(Eigen::Vector3d(0.001, 0, 0));
        frame.covariance = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
        frame.exposure_ev = 0.5 + (f % 2 == 0 ? 0.1 : 0.3);
        frame.white_balance = {1.1 * 1.02, 1, 0.9};
        frame.focus_distance_m = 0.8 * 0.97;
        frame.coc_scale_px_m = 8.8;
        frame.shutter_fraction = 0.4;
    }
    TrackPoint point;
    const Camera camera = camera_800();
    // A point volume: the mean over a box would mix depths.
    score({frames, camera}, truth, {camera, {Eigen::Vector3d::Zero()}}, "truth.json", point);
    ASSERT_TRUE(point.errors);
    EXPECT_EQ(point.errors->lost, 1);
    EXPECT_NEAR(point.errors->mean_px, 0.25, 1e-9);
    EXPECT_NEAR(point.errors->median_px, 0, 1e-9);
    EXPECT_NEAR(point.errors->max_px, 1, 1e-9);
    EXPECT_NEAR(point.errors->p95_px, 0.85, 1e-9);  // between the third and the fourth of four
    EXPECT_NEAR(*point.errors->slow_mean_px, 0.25, 1e-9);
    EXPECT_FALSE(point.errors->fast_mean_px);
    EXPECT_NEAR(*point.errors->jitter_px, 0, 1e-9);  // 0 to 1, 1 to 2; frame 4 follows a lost one
    EXPECT_NEAR(*point.errors->ev_mean, 0.15, 1e-9);
    EXPECT_NEAR(*point.errors->ev_spread, std::sqrt((3 * 0.0025 + 0.0225) / 4), 1e-9);
    EXPECT_NEAR(*point.errors->white_balance, 0.02, 1e-9);
    EXPECT_NEAR(*point.errors->focus, 0.03, 1e-9);
    EXPECT_NEAR(*point.errors->coc_scale, 0.1, 1e-9);
    EXPECT_NEAR(*point.errors->shutter, 0.1, 1e-9);
    EXPECT_NEAR(*point.errors->nees_median, 0, 1e-9);
    ASSERT_EQ(point.error_px.size(), 5u);
    EXPECT_FALSE(point.error_px[3]);
}

TEST(TrackTruth, JitterIsTheChangeOfTheSignedError) {
    const TrackTruth truth = truth_of(4, 0.02);  // 20 px a frame
    std::vector<SolvedFrame> frames(4);
    for (int f = 0; f < 4; ++f) {
        frames[static_cast<std::size_t>(f)].frame = f;
        frames[static_cast<std::size_t>(f)].camera_from_world = pose_at(0.02 * f + (f % 2 == 0 ? 0.0001 : -0.0001));
    }
    TrackPoint point;
    const Camera camera = camera_800();
    score({frames, camera}, truth, {camera, {Eigen::Vector3d::Zero()}}, "truth.json", point);
    EXPECT_NEAR(point.errors->mean_px, 0.1, 1e-9);  // always the same size
    EXPECT_NEAR(*point.errors->jitter_px, 0.2, 1e-9);
    EXPECT_NEAR(*point.errors->fast_mean_px, 0.1, 1e-9);  // all but the first, which moves from nowhere
}

TEST(TrackTruth, AnErrorAsLargeAsItsCovarianceSaysIsOne) {
    const TrackTruth truth = truth_of(1, 0);
    SolvedFrame frame;
    frame.camera_from_world = truth.frames.at(0).camera_from_world;
    frame.camera_from_world->translate(Eigen::Vector3d(0.002, 0, 0));
    frame.covariance = Eigen::Matrix<double, 6, 6>::Identity() * (0.002 * 0.002 / 6);
    TrackPoint point;
    const Camera camera = camera_800();
    const std::vector<SolvedFrame> frames{frame};
    score({frames, camera}, truth, scored_volume(camera, 0.08), "truth.json", point);
    EXPECT_NEAR(*point.errors->nees_median, 1, 1e-9);
    std::vector<SolvedFrame> elsewhere{frame};
    elsewhere[0].frame = 7;
    EXPECT_THROW(score({elsewhere, camera}, truth, scored_volume(camera, 0.08), "truth.json", point), InputError);
}

class TruthFile : public testing::Test {
protected:
    void SetUp() override {
        path_ = fs::temp_directory_path() / ("matchlight_truth_" + std::to_string(getpid()) + ".json");
    }
    void TearDown() override { fs::remove(path_); }

    std::string refusal(const std::string& text) const {
        write_text_file(path_, text);
        try {
            load_track_truth(path_);
        } catch (const InputError& error) {
            return error.what();
        }
        return {};
    }

    fs::path path_;
};

TEST_F(TruthFile, IsReadOrRefused) {
    const std::string unit = "[[1,0,0,0],[0,1,0,0],[0,0,1,0.5],[0,0,0,1]]";
    write_text_file(path_, R"({"fx": 622.2, "lens_mm": 35, "fstop": 2.8, "white_balance": [1.06, 1, 0.93], "poses": [
        {"frame": 3, "cam_from_world": )" +
                               unit + R"(, "ev": -1.5, "focus_m": 0.6}]})");
    const TrackTruth truth = load_track_truth(path_);
    ASSERT_EQ(truth.frames.count(3), 1u);
    EXPECT_DOUBLE_EQ(truth.frames.at(3).camera_from_world.translation().z(), 0.5);
    EXPECT_DOUBLE_EQ(*truth.frames.at(3).exposure_ev, -1.5);
    EXPECT_NEAR(*truth.coc_scale_px_m, 622.2 * 0.035 / 2.8, 1e-12);
    EXPECT_FALSE(truth.shutter_fraction);

    EXPECT_NE(refusal("no json").find("poses"), std::string::npos);
    EXPECT_NE(refusal("[1]").find("poses"), std::string::npos);
    EXPECT_NE(refusal(R"({"poses": []})").find("no pose"), std::string::npos);
    EXPECT_NE(refusal(R"({"poses": [{"cam_from_world": )" + unit + "}]}").find("frame"), std::string::npos);
    EXPECT_NE(refusal(R"({"poses": [{"frame": 4}]})").find("frame 4"), std::string::npos);
    EXPECT_NE(refusal(R"({"poses": [{"frame": 0, "cam_from_world": [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})")
                  .find("rigid"),
              std::string::npos);
    EXPECT_NE(refusal(R"({"poses": [{"frame": 0, "cam_from_world": )" + unit + R"(, "ev": "x"}]})").find("\"ev\""),
              std::string::npos);
    EXPECT_NE(refusal(R"({"white_balance": [1, 0, 1], "poses": [{"frame": 0, "cam_from_world": )" + unit + "}]}")
                  .find("white_balance"),
              std::string::npos);
}

/// Three tags before a camera at exact places.
struct SeenRig {
    std::vector<SolvedTag> rig;
    std::vector<FrameObservations> frames;
    std::vector<SolvedFrame> poses;
};

SeenRig seen_rig(int frames) {
    SeenRig seen;
    const Camera camera = camera_800();
    for (int id = 0; id < 3; ++id) {
        SolvedTag tag{id, 0.08, RigidTransform::Identity()};
        tag.world_from_tag.translation() = Eigen::Vector3d(0.12 * (id - 1), 0.02 * id, 0);
        seen.rig.push_back(tag);
    }
    for (int f = 0; f < frames; ++f) {
        SolvedFrame pose;
        pose.frame = f;
        pose.camera_from_world = pose_at(0.01 * f);
        FrameObservations frame{f, f / 24.0, {}};
        for (const SolvedTag& tag : seen.rig) {
            TagObservation observation;
            observation.id = tag.id;
            const Eigen::Matrix<double, 3, 4> points =
                *pose.camera_from_world * (tag.world_from_tag * tag_corners_m(tag.size_m));
            for (int i = 0; i < 4; ++i) {
                observation.corners_normalized.col(i) = points.col(i).hnormalized();
                observation.corners_px.col(i) = camera.pixel_from_camera(points.col(i));
            }
            observation.side_px = 80 + tag.id;
            observation.covariance = TagCovariance::Identity() * 1e-10;
            frame.tags.push_back(observation);
        }
        seen.frames.push_back(frame);
        seen.poses.push_back(pose);
    }
    return seen;
}

TEST(TagAgreement, IsZeroForExactTagsAndShowsOneThatMoved) {
    SeenRig seen = seen_rig(3);
    const auto from_others = [](const auto& tags, const RigidTransform&) { return solve_pnp_pose_of(tags); };
    const TagAgreement exact = tag_agreement(seen.frames, seen.poses, seen.rig, camera_800(), from_others);
    EXPECT_LT(*exact.reprojection_px, 1e-6);
    EXPECT_LT(*exact.leave_one_out_px, 1e-3);
    EXPECT_LT(*exact.leave_one_out_jitter_px, 1e-3);
    for (FrameObservations& frame : seen.frames) frame.tags[1].corners_px.row(0).array() += 2;
    // Only the residual is moved, not what poses are made of: 2 px in x of one tag in three.
    const TagAgreement moved = tag_agreement(seen.frames, seen.poses, seen.rig, camera_800(), from_others);
    EXPECT_NEAR(*moved.reprojection_px, 2 / std::sqrt(3), 1e-3);
    EXPECT_NEAR(*moved.leave_one_out_px, 2 / std::sqrt(3), 1e-2);
    EXPECT_LT(*moved.leave_one_out_jitter_px, 1e-3);
}

TEST(TagAgreement, ASingleTagSaysNothing) {
    SeenRig seen = seen_rig(2);
    for (FrameObservations& frame : seen.frames) frame.tags.resize(1);
    const TagAgreement alone =
        tag_agreement(seen.frames, seen.poses, seen.rig, camera_800(),
                      [](const auto& tags, const RigidTransform&) { return solve_pnp_pose_of(tags); });
    EXPECT_TRUE(alone.reprojection_px);
    EXPECT_FALSE(alone.leave_one_out_px);
}

TEST(PosePeers, FindExactPoses) {
    const SeenRig seen = seen_rig(1);
    const RigidTransform truth = *seen.poses[0].camera_from_world;
    const std::vector<PlacedObservation> tags = placed(seen.frames[0], seen.rig);
    ASSERT_EQ(tags.size(), 3u);
    const auto difference = [&](const RigidTransform& found) {
        return (found.matrix() - truth.matrix()).cwiseAbs().maxCoeff();
    };
    EXPECT_LT(difference(*apriltag_pose_of_largest(tags)), 1e-5);
    EXPECT_LT(difference(*solve_pnp_pose_of(tags)), 1e-6);
    EXPECT_LT(difference(*ippe_pose(tags[2].seen->corners_normalized, 0.08) * tags[2].world_from_tag.inverse()), 1e-6);
    EXPECT_FALSE(solve_pnp_pose({}));
}

TEST(PosePeers, FindPlanesFromEitherSideAtAnyTurn) {
    // OpenCV's own choice of the plane's side, and a turn by exactly 180°, must not matter.
    for (const double turn_deg : {0.0, 35.0, 90.0, 180.0}) {
        for (const double tilt_deg : {0.0, 0.5, 40.0, 140.0, 180.0}) {
            RigidTransform truth = RigidTransform::Identity();
            truth.linear() = rotation_from_degrees({tilt_deg, 0, turn_deg});
            truth.translation() = Eigen::Vector3d(0.05, -0.02, 0.8);
            std::vector<SeenPoint> points;
            for (const Eigen::Vector3d& world_m : {Eigen::Vector3d(-0.1, 0.07, 0), Eigen::Vector3d(0.2, 0.1, 0),
                                                   Eigen::Vector3d(0.1, -0.1, 0), Eigen::Vector3d(-0.15, -0.12, 0)})
                points.push_back({world_m, (truth * world_m).hnormalized()});
            const std::optional<RigidTransform> found = solve_pnp_pose(points);
            ASSERT_TRUE(found) << tilt_deg << "° " << turn_deg << "°";
            EXPECT_LT((found->matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 1e-6) << tilt_deg << "° " << turn_deg;
        }
    }
}

TEST(TagPoseTrial, NoiseCostsWhatItMust) {
    const TagPoseErrors errors = try_tag_pose({.side_px = 100, .tilt_deg = 45, .noise_px = 0.5, .frames = 200});
    ASSERT_TRUE(errors.ours);
    EXPECT_EQ(errors.found, 200);
    EXPECT_EQ(errors.mirrored, 0);
    // RMS of 200 draws: within a tenth of the Cramér–Rao bound of the middle frame, whose tilt is typical to a fifth.
    EXPECT_NEAR(*errors.ours / errors.noise_px, 1, 0.3);
    // Such an error is the most that four corners allow: OpenCV's cannot be better by more than the draw.
    EXPECT_GT(*errors.ippe, 0.9 * *errors.ours);
}

TEST(TagPoseTrial, PicturesGiveBetterPosesThanCorners) {
    const TagPoseErrors errors = try_tag_pose({.side_px = 60, .tilt_deg = 45, .noise_codes = 4, .frames = 4});
    ASSERT_TRUE(errors.ours && errors.ippe && errors.apriltag_light && errors.apriltag_codes);
    EXPECT_EQ(errors.found, 4);
    EXPECT_LT(*errors.ours, 3 * std::hypot(errors.noise_px, errors.allowance_px));
    EXPECT_LT(*errors.ours, *errors.ippe);
    EXPECT_GT(errors.noise_px, 0.001);
    EXPECT_GT(errors.edge_noise_px, errors.noise_px);  // hundreds of rows of pixels against one
}

TEST(TrackText, FilesHoldEveryWay) {
    TrackReport track;
    track.frames = 12, track.against_truth = true;
    for (const char* name : {"final", "fast & <rough>"}) {
        TrackPoint& point = track.points.emplace_back();
        point.name = name;
        point.time = {1000, 900, 1200};
        point.errors = TrackErrors{};
        point.errors->mean_px = 0.02;
        point.error_px = {0.01, std::nullopt, 0.03};
    }
    track.points[1].errors->mean_px = std::numeric_limits<double>::infinity();
    const nlohmann::json json = nlohmann::json::parse(track_json(track).dump());
    EXPECT_EQ(json["points"].size(), 2u);
    EXPECT_EQ(json["points"][0]["mean_px"], 0.02);
    EXPECT_FALSE(json["points"][1].contains("mean_px"));
    EXPECT_FALSE(json["points"][0].contains("leave_one_out_px"));
    const std::string csv = track_csv(track);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
    std::size_t commas = 0;
    for (std::size_t begin = 0; begin < csv.size(); begin = csv.find('\n', begin) + 1) {
        const std::string line = csv.substr(begin, csv.find('\n', begin) - begin);
        const auto here = static_cast<std::size_t>(std::ranges::count(line, ','));
        if (begin == 0) commas = here;
        EXPECT_EQ(here, commas) << line;
    }
    const std::string html = track_html(track);
    EXPECT_NE(html.find("fast &amp; &lt;rough&gt;"), std::string::npos);
    EXPECT_EQ(html.find("inf"), std::string::npos);
    EXPECT_EQ(html.find("nan"), std::string::npos);
    EXPECT_NE(html.find("<polyline"), std::string::npos);
}

}  // namespace
}  // namespace matchlight
