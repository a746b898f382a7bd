// Rendered boards of every kind through bent lenses: all corners, where they are.
#include "calibration/board_detector.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "calibration/saddle.h"
#include "core/error.h"
#include "synthetic_board.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

Camera vga(LensModel lens, std::vector<double> distortion) {
    Camera camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = 520;
    camera.fy = 522;
    camera.cx = 325;
    camera.cy = 236;
    camera.lens = lens;
    camera.distortion = std::move(distortion);
    return camera;
}

struct Accuracy {
    int found = 0, all = 0;
    double rms_px = 0, worst_px = 0;
    double mean_sigma_px = 0;
};

Accuracy accuracy_of(const std::string& spec, const Camera& camera, double tilt_deg) {
    const BoardSpec board = read_board(spec);
    const RigidTransform pose = test::board_poses(board, camera, 1, tilt_deg).front();
    const LensData truth = test::synthetic_corners(board, {camera, {}}, {pose}, 0);
    const BoardSighting sighting =
        BoardDetector::create(board)->detect(board_picture(test::board_photograph(board, camera, pose)));
    Accuracy accuracy;
    accuracy.all = static_cast<int>(truth.views[0].corners.size());
    accuracy.found = static_cast<int>(sighting.corners.size());
    std::vector<Vector2d> places;
    for (const BoardCorner& corner : truth.views[0].corners) places.push_back(corner.px);
    const std::size_t last = places.size() - 1;
    // A chessboard may be seen the other way round: then all of it is.
    const bool turned = !sighting.corners.empty() && (sighting.corners[0].px - places[0]).norm() > 5;
    for (const BoardCorner& corner : sighting.corners) {
        const auto index = static_cast<std::size_t>(corner.index);
        const double error = (corner.px - places[turned ? last - index : index]).norm();
        accuracy.rms_px += error * error / accuracy.found;
        accuracy.worst_px = std::max(accuracy.worst_px, error);
        accuracy.mean_sigma_px += corner.sigma_px / accuracy.found;
    }
    accuracy.rms_px = std::sqrt(accuracy.rms_px);
    return accuracy;
}

/// Codes of 8 bits and the sampling of hard edges by 6 × 6 rays leave some hundredths of a pixel.
constexpr double rendered_px = 0.03;

TEST(BoardDetector, ChessboardThroughABarrelLens) {
    const Accuracy found = accuracy_of("chessboard 9x6 0.025", vga(LensModel::radtan, {-0.28, 0.09, 1e-3, -5e-4}), 35);
    EXPECT_EQ(found.found, 54);
    EXPECT_LT(found.rms_px, rendered_px);
    EXPECT_LT(found.worst_px, 4 * rendered_px);
}

TEST(BoardDetector, CharucoThroughABarrelLens) {
    const Accuracy found =
        accuracy_of("charuco 9x7 0.03 0.022 DICT_4X4_50", vga(LensModel::radtan, {-0.28, 0.09, 1e-3, -5e-4}), 30);
    EXPECT_EQ(found.found, 48);
    EXPECT_LT(found.rms_px, rendered_px);
    EXPECT_LT(found.worst_px, 4 * rendered_px);
}

TEST(BoardDetector, AprilgridThroughAFisheyeLens) {
    Camera camera = vga(LensModel::fisheye, {0.01, -0.005, 0.001, 0});
    camera.fx = camera.fy = 330;
    const Accuracy found = accuracy_of("aprilgrid 4x3 0.06 0.3", camera, 30);
    EXPECT_EQ(found.found, 48);
    EXPECT_LT(found.rms_px, rendered_px);
    EXPECT_LT(found.worst_px, 4 * rendered_px);
}

TEST(BoardDetector, SaysWhatIsSeenInstead) {
    const Camera camera = vga(LensModel::radtan, {0, 0, 0, 0});
    const BoardSpec there = read_board("chessboard 7x5 0.03");
    const BoardPicture picture =
        board_picture(test::board_photograph(there, camera, test::board_poses(there, camera, 1, 20).front()));
    const auto chessboard = BoardDetector::create(read_board("chessboard 9x6 0.03"));
    EXPECT_TRUE(chessboard->detect(picture).corners.empty());
    const std::string seen = chessboard->seen_instead(picture);
    EXPECT_EQ(seen.find("a chessboard of at least "), 0u) << seen;
    const BoardPicture nothing = board_picture(Image8(200, 150, 3, 128));
    for (const char* spec : {"chessboard 9x6 0.03", "charuco 5x4 0.03 0.02 DICT_4X4", "aprilgrid 3x3 0.05 0.3"}) {
        const auto detector = BoardDetector::create(read_board(spec));
        EXPECT_TRUE(detector->detect(nothing).corners.empty());
        EXPECT_EQ(detector->seen_instead(nothing), "");
    }
    EXPECT_THROW(BoardDetector::create(read_board("charuco 5x4 0.03 0.02 DICT_3X3")), InputError);
    EXPECT_THROW(BoardDetector::create(read_board("charuco 20x20 0.03 0.02 DICT_4X4_50")), InputError);
}

/// Light of two edges that cross at `centre`, blurred as an ideal lens would by the pixel's own area and more.
ImageF crossing(const Vector2d& centre, double angle_1, double angle_2, double blur_px) {
    ImageF light(41, 41, 1);
    const Vector2d n1(std::cos(angle_1), std::sin(angle_1)), n2(std::cos(angle_2), std::sin(angle_2));
    for (int y = 0; y < 41; ++y) {
        for (int x = 0; x < 41; ++x) {
            const Vector2d offset = Vector2d(x, y) - centre;
            light.at(x, y) = static_cast<float>(0.45 + 0.4 * std::erf(n1.dot(offset) / (blur_px * std::sqrt(2.0))) *
                                                           std::erf(n2.dot(offset) / (blur_px * std::sqrt(2.0))));
        }
    }
    return light;
}

TEST(Saddle, FindsTheCrossing) {
    for (const double blur_px : {0.5, 1.0, 2.5}) {
        const Vector2d centre(20.3, 19.8);
        const ImageF light = crossing(centre, 0.2, 1.9, blur_px);
        SaddleGuess guess{centre + Vector2d(0.8, -0.7), Eigen::Matrix2d(), 0.01};
        guess.px_from_board << -std::sin(0.25), -std::sin(1.8), std::cos(0.25), std::cos(1.8);
        guess.px_from_board *= 1000;
        const auto saddle = fit_saddle(light, guess);
        ASSERT_TRUE(saddle.has_value());
        EXPECT_LT((saddle->px - centre).norm(), 1e-3);
        EXPECT_NEAR(saddle->blur_px, blur_px, 0.01);
        EXPECT_NEAR(saddle->contrast, 0.8, 0.01);
    }
}

TEST(Saddle, IsNotFoundWhereThereIsNone) {
    SaddleGuess guess{{20, 20}, Eigen::Matrix2d::Identity() * 1000, 0.008};
    EXPECT_FALSE(fit_saddle(ImageF(41, 41, 1, 0.5f), guess).has_value());
    ImageF edge(41, 41, 1, 0.1f);
    for (int y = 0; y < 41; ++y) {
        for (int x = 20; x < 41; ++x) edge.at(x, y) = 0.9f;
    }
    EXPECT_FALSE(fit_saddle(edge, guess).has_value());
    guess.px = {2, 2};  // too near the picture's edge
    EXPECT_FALSE(fit_saddle(edge, guess).has_value());
    guess.px = {std::nan(""), 2};
    EXPECT_FALSE(fit_saddle(edge, guess).has_value());
}

}  // namespace
}  // namespace matchlight
