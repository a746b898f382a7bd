// The lens against OpenCV's own functions, its inverse against itself, and the pixels that no ray reaches.
#include "calibration/camera.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "core/error.h"

namespace matchlight {
namespace {

Camera wide_camera(std::vector<double> distortion) {
    Camera camera;
    camera.width = 1280;
    camera.height = 720;
    camera.fx = 900.5;
    camera.fy = 905.25;
    camera.cx = 641.3;
    camera.cy = 355.8;
    camera.distortion = std::move(distortion);
    return camera;
}

cv::Mat opencv_matrix(const Camera& camera) {
    return (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

/// Every count of coefficients that OpenCV takes; none folds inside the picture.
const std::vector<std::vector<double>> radtan_cases = {
    {},
    {-0.28, 0.09, 0.0007, -0.0004},
    {-0.09, 0.03, 0.0005, -0.0003, 0.002},
    {0.12, -0.05, 0.001, -0.0008, 0.01, 0.09, -0.02, 0.004},
    {-0.21, 0.06, 0.0004, 0.0006, -0.003, 0.02, 0.01, 0.001, 0.003, -0.002, -0.004, 0.001},
    {-0.21, 0.06, 0.0004, 0.0006, -0.003, 0.02, 0.01, 0.001, 0.003, -0.002, -0.004, 0.001, 0.02, -0.035},
};

class RadtanCamera : public testing::TestWithParam<std::size_t> {
protected:
    Camera camera_ = wide_camera(radtan_cases[GetParam()]);
};

TEST_P(RadtanCamera, ProjectsAsOpencvDoes) {
    std::vector<cv::Point3d> points;
    for (double y = -0.4; y <= 0.4; y += 0.1) {
        for (double x = -0.7; x <= 0.7; x += 0.1) points.emplace_back(x * 2.5, y * 2.5, 2.5);
    }
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, cv::Mat::zeros(3, 1, CV_64F), cv::Mat::zeros(3, 1, CV_64F), opencv_matrix(camera_),
                      camera_.distortion, pixels);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d pixel = camera_.pixel_from_camera({points[i].x, points[i].y, points[i].z});
        EXPECT_NEAR(pixel.x(), pixels[i].x, 1e-9);  // the same formula in the same precision
        EXPECT_NEAR(pixel.y(), pixels[i].y, 1e-9);
    }
}

TEST_P(RadtanCamera, InvertsItsProjectionOverTheWholePicture) {
    for (int y = 0; y < camera_.height; y += 45) {
        for (int x = 0; x < camera_.width; x += 40) {
            const Eigen::Vector2d normalized = camera_.normalized_from_pixel({x, y});
            ASSERT_TRUE(normalized.allFinite()) << x << ", " << y;
            const Eigen::Vector2d pixel = camera_.pixel_from_normalized(normalized);
            EXPECT_NEAR(pixel.x(), x, 1e-9);
            EXPECT_NEAR(pixel.y(), y, 1e-9);
        }
    }
}

TEST_P(RadtanCamera, UndistortsAsOpencvDoes) {
    std::vector<cv::Point2d> pixels, normalized;
    for (int y = 40; y < camera_.height; y += 80) {
        for (int x = 40; x < camera_.width; x += 80) pixels.emplace_back(x, y);
    }
    cv::undistortPoints(pixels, normalized, opencv_matrix(camera_), camera_.distortion, cv::noArray(), cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 1000, 1e-13));
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Eigen::Vector2d ours = camera_.normalized_from_pixel({pixels[i].x, pixels[i].y});
        EXPECT_NEAR(ours.x(), normalized[i].x, 1e-8);  // its fixed-point iteration stops near there
        EXPECT_NEAR(ours.y(), normalized[i].y, 1e-8);
    }
}

INSTANTIATE_TEST_SUITE_P(all_coefficient_counts, RadtanCamera, testing::Range<std::size_t>(0, 6));

TEST(FisheyeCamera, AgreesWithOpencvBothWays) {
    Camera camera = wide_camera({-0.013, 0.021, -0.009, 0.0012});
    camera.lens = LensModel::fisheye;
    camera.fx = camera.fy = 420;  // the corner sees 100° across the diagonal
    std::vector<cv::Point3d> points;
    for (double y = -0.8; y <= 0.81; y += 0.2) {
        for (double x = -1.4; x <= 1.41; x += 0.2) points.emplace_back(x, y, 1);
    }
    std::vector<cv::Point2d> pixels;
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), opencv_matrix(camera),
                               camera.distortion);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d pixel = camera.pixel_from_camera({points[i].x, points[i].y, points[i].z});
        EXPECT_NEAR(pixel.x(), pixels[i].x, 1e-9);
        EXPECT_NEAR(pixel.y(), pixels[i].y, 1e-9);
        const Eigen::Vector2d back = camera.normalized_from_pixel(pixel);
        EXPECT_NEAR(back.x(), points[i].x, 1e-10);
        EXPECT_NEAR(back.y(), points[i].y, 1e-10);
    }
}

TEST(FisheyeCamera, WithoutCoefficientsIsEquidistant) {
    Camera camera = wide_camera({});
    camera.lens = LensModel::fisheye;
    // A ray 45° off the axis lands π/4 focal lengths from the centre.
    EXPECT_NEAR(camera.pixel_from_normalized({1, 0}).x(), camera.cx + camera.fx * std::acos(-1) / 4, 1e-10);
    EXPECT_TRUE(camera.has_distortion());
}

TEST(FisheyeCamera, ReachesNoPixelBeyond90Degrees) {
    Camera camera = wide_camera({0, 0, 0, 0});
    camera.lens = LensModel::fisheye;
    camera.fx = camera.fy = 300;  // 90° is 471 px from the centre, the corner 737
    EXPECT_TRUE(camera.normalized_from_pixel({camera.cx + 460, camera.cy}).allFinite());
    EXPECT_FALSE(camera.normalized_from_pixel({camera.cx + 480, camera.cy}).allFinite());
}

TEST(FoldedLens, GivesNanWhereTheModelDoesNotReachAndTheInnerBranchElsewhere) {
    // r·(1 − r²/3) turns at r = 1, where it is 2/3.
    const Camera camera = wide_camera({-1.0 / 3, 0, 0, 0});
    const double reach_px = camera.fx * 2 / 3;
    EXPECT_FALSE(camera.normalized_from_pixel({camera.cx + reach_px + 1, camera.cy}).allFinite());
    for (const double r : {0.2, 0.5, 0.8, 0.95, 0.99}) {
        const Eigen::Vector2d expected(r * std::cos(0.7), r * std::sin(0.7));
        const Eigen::Vector2d found = camera.normalized_from_pixel(camera.pixel_from_normalized(expected));
        // The slope towards the fold is 1 − r²: the pixel's rounding grows by its inverse, to 1e-11 at r = 0.99.
        EXPECT_NEAR(found.x(), expected.x(), 1e-10) << r;
        EXPECT_NEAR(found.y(), expected.y(), 1e-10) << r;
    }
    // A point beyond the fold projects where an inner one does; the inverse returns the inner one.
    const Eigen::Vector2d inner = camera.normalized_from_pixel(camera.pixel_from_normalized({1.3, 0}));
    ASSERT_TRUE(inner.allFinite());
    EXPECT_LT(inner.norm(), 1);
}

TEST(StrongDistortion, StillInverts) {
    // An action camera: the five iterations that cv::undistortPoints makes by default miss its corners by 6e-4.
    const Camera camera = [] {
        Camera c = wide_camera({-0.33, 0.16, 0.001, -0.0005, -0.035});
        c.fx = c.fy = 620;
        return c;
    }();
    int reached = 0;
    for (double y = -0.55; y <= 0.551; y += 0.05) {
        for (double x = -0.95; x <= 0.951; x += 0.05) {
            const Eigen::Vector2d found = camera.normalized_from_pixel(camera.pixel_from_normalized({x, y}));
            if (!found.allFinite()) continue;
            ++reached;
            EXPECT_NEAR(found.x(), x, 1e-10);
            EXPECT_NEAR(found.y(), y, 1e-10);
        }
    }
    EXPECT_EQ(reached, 23 * 39);
}

TEST(CameraForSize, KeepsTheFieldOfView) {
    const Camera camera = wide_camera({-0.1, 0.02, 0, 0});
    const Camera half = camera_for_size(camera, 640, 360, "clip.mp4");
    // The centre of the picture stays the centre: pixel centres lie at whole numbers, edges at halves.
    const Eigen::Vector2d full_pixel = camera.pixel_from_normalized({0.3, -0.2});
    const Eigen::Vector2d half_pixel = half.pixel_from_normalized({0.3, -0.2});
    EXPECT_NEAR(half_pixel.x() + 0.5, (full_pixel.x() + 0.5) / 2, 1e-10);
    EXPECT_NEAR(half_pixel.y() + 0.5, (full_pixel.y() + 0.5) / 2, 1e-10);
    EXPECT_THROW(camera_for_size(camera, 720, 720, "clip.mp4"), InputError);
}

}  // namespace
}  // namespace matchlight
