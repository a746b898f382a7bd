// Lenses of known parameters, from corners with known noise: what is recovered, chosen, refused.
#include "calibration/lens_calibration.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "calibration/lens_comparison.h"
#include "calibration/lens_page.h"
#include "calibration/view_choice.h"
#include "core/error.h"
#include "synthetic_board.h"

namespace matchlight {
namespace {

Camera hd(LensModel lens, double focal_px, std::vector<double> distortion) {
    Camera camera;
    camera.width = 1280;
    camera.height = 720;
    camera.fx = focal_px;
    camera.fy = 1.002 * focal_px;
    camera.cx = 651;
    camera.cy = 348;
    camera.lens = lens;
    camera.distortion = std::move(distortion);
    return camera;
}

const char* const chessboard = "chessboard 9x6 0.03";
constexpr double noise_px = 0.08;

LensData views_of(const test::SyntheticLens& lens, int count, double tilt_deg, double noise = noise_px) {
    const BoardSpec board = read_board(chessboard);
    return test::synthetic_corners(board, lens, test::board_poses(board, lens.camera, count, tilt_deg), noise);
}

LensCalibration calibrate(const LensData& data, const LensOptions& options = {}) {
    Warnings warnings;
    warnings.set_quiet(true);
    return calibrate_lens(data, options, warnings);
}

std::string error_of(const LensData& data) {
    try {
        (void)calibrate(data);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

/// Every parameter within four of its sigmas: once in 16,000 by chance, for a fixed seed a matter of being right.
void expect_recovered(const LensCalibration& found, const Camera& truth) {
    const std::vector<double> matrix = {truth.fx, truth.fy, truth.cx, truth.cy};
    for (std::size_t i = 0; i < found.parameters.size(); ++i) {
        const ParameterEstimate& p = found.parameters[i];
        const double is = i < 4 ? matrix[i] : i - 4 < truth.distortion.size() ? truth.distortion[i - 4] : 0;
        EXPECT_GT(p.sigma, 0) << p.name;
        EXPECT_LT(std::abs(p.value - is), 4 * p.sigma) << p.name << " " << p.value << " for " << is;
    }
    // A quarter of a percent of the focal length: the sigmas are not merely large.
    EXPECT_LT(found.parameters[0].sigma, 0.0025 * truth.fx);
}

TEST(LensCalibration, RecoversARadialTangentialLens) {
    const Camera truth = hd(LensModel::radtan, 1000, {-0.24, 0.08, 8e-4, -5e-4});
    const LensCalibration found = calibrate(views_of({truth, {}}, 16, 45));
    EXPECT_EQ(found.fit.candidate.lens, LensModel::radtan);
    EXPECT_FALSE(found.fit.candidate.bent_board);
    expect_recovered(found, truth);
    // Noise of both coordinates, less what 6 numbers a view and the lens take up.
    EXPECT_NEAR(found.fit.rms_px, noise_px * std::sqrt(2.0), 0.08 * noise_px);
    EXPECT_GT(found.held_out_px, found.fit.rms_px);
    EXPECT_LT(found.pixels.rms_px, 0.1);
    ASSERT_TRUE(found.camera.sigmas.has_value());
    EXPECT_EQ(found.camera.sigmas->fx, found.parameters[0].sigma);
    EXPECT_EQ(found.dropped_corners, 0);
}

TEST(LensCalibration, RecoversAFisheyeLens) {
    const Camera truth = hd(LensModel::fisheye, 420, {0.02, -0.008, 0.002, -0.0005});
    const LensCalibration found = calibrate(views_of({truth, {}}, 16, 45));
    EXPECT_EQ(found.fit.candidate.lens_name(), "fisheye");
    expect_recovered(found, truth);
}

TEST(LensCalibration, FindsThatTheBoardIsBent) {
    const Camera truth = hd(LensModel::radtan, 1000, {-0.1, 0.03, 0, 0});
    LensOptions radtan2;
    radtan2.lens = LensModel::radtan;
    radtan2.most_radial_terms = 2;
    const LensCalibration found = calibrate(views_of({truth, {6e-4, -4e-4, 2e-4}}, 16, 45), radtan2);
    EXPECT_TRUE(found.fit.candidate.bent_board);
    EXPECT_NEAR(found.fit.bend_m[0], 6e-4, 4 * found.bend_sigma_m[0]);
    EXPECT_NEAR(found.fit.bend_m[1], -4e-4, 4 * found.bend_sigma_m[1]);
    EXPECT_NEAR(found.fit.bend_m[2], 2e-4, 4 * found.bend_sigma_m[2]);
    expect_recovered(found, truth);
}

TEST(LensCalibration, LeavesOutWhatIsWrong) {
    const Camera truth = hd(LensModel::radtan, 1000, {-0.1, 0.03, 0, 0});
    LensData data = views_of({truth, {}}, 14, 45);
    for (const std::size_t i : {3u, 20u, 40u}) data.views[2].corners[i].px += Eigen::Vector2d(4, -3);
    for (BoardCorner& corner : data.views[7].corners) {
        corner.px += 3 * Eigen::Vector2d(std::sin(7.0 * corner.index), std::cos(13.0 * corner.index));
    }
    Warnings warnings;
    warnings.set_quiet(true);
    const LensCalibration found = calibrate_lens(data, {}, warnings);
    EXPECT_EQ(found.dropped_corners, 3);
    EXPECT_EQ(found.dropped_views, std::vector<std::string>{"view 7"});
    EXPECT_GE(warnings.total(), 2);
    expect_recovered(found, truth);
}

TEST(LensCalibration, RefusesWhatDoesNotDetermineTheLens) {
    const Camera truth = hd(LensModel::radtan, 1000, {-0.1, 0.03, 0, 0});
    const std::string frontal = error_of(views_of({truth, {}}, 12, 0.5));
    EXPECT_NE(frontal.find("focal length"), std::string::npos) << frontal;
    EXPECT_NE(frontal.find("tilted"), std::string::npos) << frontal;
    // Without noise, too.
    EXPECT_NE(error_of(views_of({truth, {}}, 12, 0, 0)).find("focal length"), std::string::npos);
    const std::string few = error_of(views_of({truth, {}}, 3, 45));
    EXPECT_NE(few.find("at least 4 views"), std::string::npos) << few;
}

TEST(LensCalibration, IsTheSameEveryTime) {
    const LensData data = views_of({hd(LensModel::radtan, 900, {-0.2, 0.05, 0, 0}), {}}, 8, 40);
    const LensCalibration once = calibrate(data), again = calibrate(data);
    EXPECT_EQ(once.fit.candidate, again.fit.candidate);
    EXPECT_EQ(once.fit.lens, again.fit.lens);
    EXPECT_EQ(once.held_out_px, again.held_out_px);
}

TEST(LensCalibration, IsNoWorseThanOpenCvOnTheSameCorners) {
    LensOptions radtan3;
    radtan3.lens = LensModel::radtan;
    radtan3.least_radial_terms = radtan3.most_radial_terms = 3;
    const LensCalibration found =
        calibrate(views_of({hd(LensModel::radtan, 900, {-0.2, 0.05, 0, 0, 0.01}), {3e-4, 3e-4, 0}}, 10, 40), radtan3);
    const std::vector<ComparedCalibration> compared = compare_with_opencv(found);
    ASSERT_EQ(compared.size(), 1u);  // its own corners were not measured
    EXPECT_LE(found.fit.rms_px, compared[0].rms_px);
    EXPECT_LT(found.held_out_px, compared[0].held_out_px);
}

TEST(LensPage, ShowsTheCalibration) {
    LensOptions radtan2;
    radtan2.lens = LensModel::radtan;
    radtan2.most_radial_terms = 2;
    LensData data = views_of({hd(LensModel::radtan, 1000, {-0.1, 0.03, 0, 0}), {}}, 8, 40);
    data.views[0].name = "<b>&.jpg";
    const LensCalibration found = calibrate(data, radtan2);
    const std::string page = lens_page(found, {"8 photographs", compare_with_opencv(found)});
    EXPECT_EQ(page.find("<b>&"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos);  // needs nothing else
    for (const char* part : {"&lt;b&gt;&amp;.jpg", "radtan2", "Against OpenCV", "Where the corners lay", "</html>"}) {
        EXPECT_NE(page.find(part), std::string::npos) << part;
    }
    std::size_t corners = 0, arrows = 0;
    for (const LensView& view : found.data.views) corners += view.corners.size();
    for (std::size_t at = page.find("<path d="); at != std::string::npos; at = page.find("<path d=", at + 1)) ++arrows;
    EXPECT_EQ(arrows, corners);
}

TEST(ViewChoice, TakesSharpViewsThatDiffer) {
    const BoardSpec board = read_board(chessboard);
    const Camera camera = hd(LensModel::radtan, 1000, {0, 0, 0, 0});
    std::vector<RigidTransform> poses;
    // Each pose is held for five frames, as by a hand that rests.
    for (const RigidTransform& pose : test::board_poses(board, camera, 12, 45)) poses.insert(poses.end(), 5, pose);
    LensData data = test::synthetic_corners(board, {camera, {}}, poses, 0.02);
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        for (BoardCorner& corner : data.views[v].corners) corner.blur_px = v % 5 == 3 ? 0.6 : v % 5 == 1 ? 3 : 0.8;
    }
    const std::vector<std::size_t> chosen = choose_views(data, 12);
    ASSERT_EQ(chosen.size(), 12u);
    std::vector<std::size_t> poses_chosen;
    for (const std::size_t v : chosen) {
        EXPECT_NE(v % 5, 1u);  // a blurred one
        poses_chosen.push_back(v / 5);
    }
    EXPECT_TRUE(std::ranges::is_sorted(chosen));
    poses_chosen.erase(std::unique(poses_chosen.begin(), poses_chosen.end()), poses_chosen.end());
    EXPECT_EQ(poses_chosen.size(), 12u);  // every pose once
    EXPECT_EQ(choose_views(data, 12), chosen);
    EXPECT_EQ(choose_views(data, 100).size(), data.views.size());
}

}  // namespace
}  // namespace matchlight
