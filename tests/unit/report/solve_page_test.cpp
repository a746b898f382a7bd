// What a solve's page flags, measures and draws, on solves whose faults are known.
#include "report/solve_page.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "report/curve_plot.h"

namespace matchlight {
namespace {

/// A camera half a metre over a tag of 8 cm at the origin and one of 4 cm beside it.
struct Clip {
    Solve solve;
    TrackDetails details;

    explicit Clip(int frames) {
        solve.footage_file = "clip.mp4";
        solve.camera.width = 320;
        solve.camera.height = 240;
        solve.camera.fx = solve.camera.fy = 300;
        solve.camera.cx = 159.5;
        solve.camera.cy = 119.5;
        RigidTransform beside = RigidTransform::Identity();
        beside.translate(Eigen::Vector3d(0.1, 0.02, 0));
        solve.rig = {{0, 0.08, RigidTransform::Identity()}, {4, 0.04, beside}};
        for (int i = 0; i < frames; ++i) {
            SolvedFrame& frame = solve.frames.emplace_back();
            frame.frame = i;
            frame.time_s = i / 25.0;
            RigidTransform pose = RigidTransform::Identity();
            pose.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
            pose.translation() = Eigen::Vector3d(0.002 * i, 0, 0.5);
            frame.camera_from_world = pose;
            frame.covariance = Eigen::Matrix<double, 6, 6>::Identity() * 1e-10;
            frame.reprojection_px = 0.05 + 0.001 * (i % 5);
            frame.pose_confidence = 1;
            frame.exposure_ev = 0.01 * i;
            frame.tags = {0, 4};
            PathFrame& path = details.path.emplace_back();
            path.frame = i;
            FrameObservations& seen = details.observations.emplace_back();
            seen.frame = i;
            for (const SolvedTag& tag : solve.rig) {
                TagObservation& observation = seen.tags.emplace_back();
                observation.id = tag.id;
                const Eigen::Matrix<double, 3, 4> corners = pose * tag.world_from_tag * tag_corners_m(tag.size_m);
                for (int c = 0; c < 4; ++c) {
                    observation.corners_px.col(c) = solve.camera.pixel_from_camera(corners.col(c));
                }
            }
        }
        solve.frame_count = frames;
    }

    std::string page(const std::string& title = "clip.toml", std::vector<std::int64_t>* asked = nullptr) const {
        const std::vector<Warnings::Entry> warnings{{"clip.mp4: 3 frames <odd>", 1}};
        return solve_page_html({solve, details, warnings, title, [&](std::int64_t frame) -> std::optional<Image8> {
                                    if (asked != nullptr) asked->push_back(frame);
                                    return Image8(320, 240, 3, 90);
                                }});
    }
};

const FlaggedRun* flag_of(const SolveFindings& found, const std::string& part) {
    for (const FlaggedRun& run : found.flagged) {
        if (run.reason.find(part) != std::string::npos) return &run;
    }
    return nullptr;
}

TEST(SolveFindings, APerfectSolveHasNoFlags) {
    const Clip clip(20);
    const SolveFindings found = find_weak_points(clip.solve, clip.details);
    EXPECT_TRUE(found.flagged.empty());
    ASSERT_EQ(found.tags.size(), 2u);
    EXPECT_EQ(found.tags[1].frames, 20);
    EXPECT_LT(found.tags[1].rms_px, 1e-9);
    EXPECT_NEAR(*found.median_reprojection_px, 0.052, 1e-12);
}

TEST(SolveFindings, ResidualsAreTheTagsOwn) {
    Clip clip(10);
    for (FrameObservations& seen : clip.details.observations) {
        seen.tags[1].corners_px.row(0).array() += 0.3;  // a tag that lies elsewhere than its place says
    }
    clip.details.observations[7].tags[1].corners_px.row(1).array() -= 0.4;
    const SolveFindings found = find_weak_points(clip.solve, clip.details);
    EXPECT_LT(found.tags[0].rms_px, 1e-9);
    EXPECT_NEAR(found.tags[1].mean_px.x(), 0.3, 1e-9);
    EXPECT_NEAR(found.tags[1].mean_px.y(), -0.04, 1e-9);
    EXPECT_NEAR(found.tags[1].worst_px, 0.5, 1e-9);
    EXPECT_EQ(found.tags[1].worst_frame, 7);
    EXPECT_NEAR(found.tags[1].rms_px, std::sqrt(0.09 + 0.016), 1e-9);
}

TEST(SolveFindings, TheTwinThatFitsIsTheOneUsed) {
    Clip clip(3);
    TagObservation twin = clip.details.observations[1].tags[0];
    twin.corners_px.array() += 40;
    clip.details.observations[1].tags.insert(clip.details.observations[1].tags.begin(), twin);
    clip.details.path[1].seen_twice = true;
    const SolveFindings found = find_weak_points(clip.solve, clip.details);
    EXPECT_LT(found.tags[0].rms_px, 1e-9);
    ASSERT_NE(flag_of(found, "seen twice"), nullptr);
    EXPECT_EQ(flag_of(found, "seen twice")->first, 1);
}

TEST(SolveFindings, FlagsRunsWithTheirWorstFrame) {
    Clip clip(40);
    for (const int i : {5, 6}) clip.solve.frames[static_cast<std::size_t>(i)].camera_from_world.reset();
    for (const int i : {10, 11, 12}) {
        clip.solve.frames[static_cast<std::size_t>(i)].bridged = true;
        clip.solve.frames[static_cast<std::size_t>(i)].reprojection_px.reset();
    }
    clip.solve.frames[20].reprojection_px = 0.4;
    clip.solve.frames[21].reprojection_px = 0.7;
    clip.solve.frames[25].pose_confidence = 0.2;
    clip.solve.frames[30].covariance = Eigen::Matrix<double, 6, 6>::Identity() * 1e-4;
    for (std::size_t i = 33; i < 40; ++i) *clip.solve.frames[i].exposure_ev -= 0.5;
    clip.details.path[35].disagreeing = true;
    const SolveFindings found = find_weak_points(clip.solve, clip.details);
    ASSERT_EQ(found.flagged.size(), 7u);
    EXPECT_EQ(found.flagged[0].reason, "no pose");  // what is worst comes first
    EXPECT_EQ(found.flagged[0].first, 5);
    EXPECT_EQ(found.flagged[0].last, 6);
    EXPECT_EQ(flag_of(found, "bridged")->last, 12);
    EXPECT_EQ(flag_of(found, "uncertain")->worst, 30);
    EXPECT_EQ(flag_of(found, "residuals far")->first, 20);
    EXPECT_EQ(flag_of(found, "residuals far")->worst, 21);
    EXPECT_NE(flag_of(found, "residuals far")->worst_value.find("0.70 px"), std::string::npos);
    EXPECT_EQ(flag_of(found, "disagree")->worst, 35);
    EXPECT_EQ(flag_of(found, "low confidence of the pose")->worst, 25);
    EXPECT_EQ(flag_of(found, "exposure jumps")->worst, 33);
}

TEST(SolveFindings, PredictedErrorIsWhatTheCovarianceScatters) {
    const Clip clip(1);
    // Uneven and correlated: rotation (rad), then translation (m), on the world side.
    Eigen::Matrix<double, 6, 6> factor = Eigen::Matrix<double, 6, 6>::Zero();
    factor.diagonal() << 4e-4, 2e-4, 3e-4, 1e-4, 2e-4, 3e-4;
    factor(4, 0) = 2e-4;
    const Eigen::Matrix<double, 6, 6> covariance = factor * factor.transpose();
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    double squares = 0;
    constexpr int draws = 20000;
    const RigidTransform pose = *clip.solve.frames[0].camera_from_world;
    for (int i = 0; i < draws; ++i) {
        Eigen::Matrix<double, 6, 1> unit;
        for (double& value : unit) value = normal(random);
        const RigidTransform moved = perturbed(pose, factor * unit);
        for (const SolvedTag& tag : clip.solve.rig) {
            const Eigen::Matrix<double, 3, 4> corners = tag.world_from_tag * tag_corners_m(tag.size_m);
            for (int c = 0; c < 4; ++c) {
                squares += (clip.solve.camera.pixel_from_camera(moved * Eigen::Vector3d(corners.col(c))) -
                            clip.solve.camera.pixel_from_camera(pose * Eigen::Vector3d(corners.col(c))))
                               .squaredNorm();
            }
        }
    }
    // 20,000 draws of six numbers: their RMS scatters by half a percent; three times that.
    const double expected = std::sqrt(squares / (8.0 * draws));
    EXPECT_NEAR(*predicted_error_px(clip.solve, pose, covariance), expected, 0.015 * expected);
}

TEST(SolvePage, ShowsFlaggedFramesFirstAndNeedsNothingElse) {
    Clip clip(30);
    clip.solve.frames[20].reprojection_px = 3;
    clip.solve.frames[4].camera_from_world.reset();
    std::vector<std::int64_t> asked;
    const std::string page = clip.page("a<b>.toml", &asked);
    EXPECT_NE(page.find("<h1>Solve of a&lt;b&gt;.toml</h1>"), std::string::npos);
    EXPECT_NE(page.find("3 frames &lt;odd&gt;"), std::string::npos);
    EXPECT_LT(page.find("Flagged frames"), page.find("id=\"path\""));
    EXPECT_EQ(asked, (std::vector<std::int64_t>{0, 4, 20}));  // decoded in order; two flagged, one that is not
    EXPECT_LT(page.find("<strong>Frame 4<"), page.find("<strong>Frame 20<"));
    EXPECT_LT(page.find("<strong>Frame 20<"), page.find("<strong>Frame 0<"));
    EXPECT_NE(page.find("src=\"data:image/jpeg;base64,/9j/"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos);
    EXPECT_NE(page.find("The footage does not say: white balance, focus, aperture, shutter."), std::string::npos);
}

TEST(SolvePage, ShowsAtMostADozenPicturesOfEachKindOfFault) {
    Clip clip(200);
    for (std::size_t i = 0; i < 200; i += 4) clip.solve.frames[i].pose_confidence = 0.1;
    clip.details.path[77].outvoted = true;
    std::vector<std::int64_t> asked;
    const std::string page = clip.page("clip.toml", &asked);
    EXPECT_EQ(asked.size(), 12u);
    EXPECT_NE(std::ranges::find(asked, 77), asked.end());  // the many do not crowd out the one
}

TEST(SolvePage, StandsClipsOfOneFrameAndWithoutPoses) {
    Clip one(1);
    EXPECT_NE(one.page().find("</html>"), std::string::npos);
    Clip lost(3);
    for (SolvedFrame& frame : lost.solve.frames) frame.camera_from_world.reset();
    const std::string page = lost.page();
    EXPECT_NE(page.find("No frame has a pose."), std::string::npos);
    EXPECT_NE(page.find("0–2"), std::string::npos);
}

TEST(SolvePage, SaysWhatIsKnownOfTheLens) {
    Clip clip(2);
    clip.solve.lens_parameters = {{"fx", 0.5, true}, {"k1", 0.001, false}};
    clip.solve.camera.distortion = {-0.1, 0, 0, 0};
    clip.solve.vignette = {-0.2, -0.1};
    clip.solve.readout_s = 0.012;
    const std::string page = clip.page();
    EXPECT_NE(page.find("300 ± 0.5 (refined by the clip)"), std::string::npos);
    EXPECT_NE(page.find("k1 -0.1 ± 0.001, k2 0"), std::string::npos);
    EXPECT_NE(page.find("70.0 % of the light in the corners"), std::string::npos);
    EXPECT_NE(page.find("12.00 ms from the first row"), std::string::npos);
}

TEST(CurvePlot, BreaksWhereNothingIsKnown) {
    CurvePlot plot{"error, px", {0, 1, 2, 3, 4, 9}, {{"e", {1.0, 2.0, std::nullopt, 3.0, 4.0, 5.0}}}, {}};
    const std::string svg = curve_plot_svg(plot);
    std::size_t lines = 0;
    for (std::size_t at = svg.find("<polyline"); at != std::string::npos; at = svg.find("<polyline", at + 1)) ++lines;
    EXPECT_EQ(lines, 2u);
    EXPECT_NE(svg.find("<circle"), std::string::npos);  // frame 9 stands alone
    plot.curves[0].values.assign(6, std::nullopt);
    EXPECT_TRUE(curve_plot_svg(plot).empty());
}

TEST(CurvePlot, AxesHoldTheirValues) {
    for (const auto& [low, high] :
         std::vector<std::pair<double, double>>{{0, 1}, {-3.7, 12}, {1e-7, 2e-7}, {99, 1e5}}) {
        const std::vector<double> ticks = axis_ticks(low, high);
        EXPECT_LE(ticks.front(), low);
        EXPECT_GE(ticks.back(), high);
        EXPECT_GE(ticks.size(), 4u);
        EXPECT_LE(ticks.size(), 10u);
    }
    // Every drawn point lies inside the plot, whatever the axis.
    for (const auto axis : {CurvePlot::Axis::fitted, CurvePlot::Axis::from_zero, CurvePlot::Axis::logarithmic}) {
        const std::string svg = curve_plot_svg({"v", {0, 1, 2, 3}, {{"v", {0.0, 0.05, 90.0, 1e-9}}}, {}, axis});
        const std::size_t at = svg.find("points=\"") + 8;
        std::istringstream points(svg.substr(at, svg.find('"', at) - at));
        int count = 0;
        char comma = 0;
        for (double x = 0, y = 0; points >> x >> comma >> y; ++count) {
            EXPECT_GE(y, 25.9);
            EXPECT_LE(y, 184.1);
        }
        EXPECT_EQ(count, 4);
    }
}

}  // namespace
}  // namespace matchlight
