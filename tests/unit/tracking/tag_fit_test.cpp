// Recovery of exactly known corners from rendered tags: clean, blurred, noisy, moved, hidden in part.
#include "tracking/tag_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "synthetic_view.h"
#include "tracking/camera_pose.h"

namespace matchlight {
namespace {

using test::orbit_pose;
using test::ordinary_camera;
using test::render_light;
using test::rough_detection;
using test::SyntheticTag;
using test::SyntheticView;
using test::true_corners_px;

constexpr double never_clipped = 2;

SyntheticTag tag_of(const std::string& family, int id) {
    SyntheticTag tag;
    tag.pattern = TagFamily(family).pattern(id);
    tag.id = id;
    return tag;
}

SyntheticView view_of(const RigidTransform& pose) {
    SyntheticView view;
    view.camera = ordinary_camera();
    view.camera_from_world = pose;
    return view;
}

Eigen::Matrix<double, 2, 4> error_px(const SyntheticView& view, const SyntheticTag& tag, const TagImageFit& fit) {
    return fit.observation.corners_px - true_corners_px(view, tag);
}

double rms(const Eigen::Matrix<double, 2, 4>& error) {
    return std::sqrt(error.squaredNorm() / 4);
}

std::optional<TagImageFit> fitted(const SyntheticView& view, const SyntheticTag& tag, double start_error_px = 0.7) {
    const LensGrid lens(view.camera);
    return fit_tag({render_light(view, {tag}), 0, 0, lens, never_clipped}, tag.pattern,
                   rough_detection(view, tag, start_error_px));
}

TEST(TagFit, PinsTheHalfPixelConvention) {
    // A tag parallel to the image plane, without distortion, drawn by exact areas: every edge at a known fraction of a
    // pixel, a different one in x and y. A convention half a pixel off would show as 0.5.
    SyntheticView view = view_of(orbit_pose(0.6, 0, 0, 0));
    view.camera.distortion.clear();
    const SyntheticTag tag = tag_of("tag36h11", 3);
    const auto fit = fitted(view, tag);
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->observation.refined);
    EXPECT_LT(error_px(view, tag, *fit).cwiseAbs().maxCoeff(), 0.02);
}

TEST(TagFit, AgreesWithTheDetectorsConvention) {
    SyntheticView view = view_of(orbit_pose(0.55, 25, 30, 10));
    view.blur_px = 0.6;
    const SyntheticTag tag = tag_of("tag36h11", 3);
    const auto detections = TagDetector("tag36h11", {}).detect(detection_image(render_light(view, {tag})));
    ASSERT_EQ(detections.size(), 1u);
    EXPECT_EQ(detections[0].id, 3);
    const Eigen::Matrix<double, 2, 4> truth = true_corners_px(view, tag);
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d error = detections[0].corners_px[static_cast<std::size_t>(i)] - truth.col(i);
        EXPECT_LT(error.norm(), 0.5) << "corner " << i << " is another corner of the sheet";
        mean += error / 4;
    }
    // The library's own corners scatter by a tenth of a pixel; a half-pixel slip would move their mean by 0.5.
    EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.1);
}

TEST(TagFit, RecoversCornersThroughTheLensAtAnyTilt) {
    for (const double tilt : {5.0, 35.0, 60.0}) {
        for (const double turn : {0.0, 40.0, 170.0}) {
            const SyntheticView view = view_of(orbit_pose(0.5, tilt, turn, 20));
            const SyntheticTag tag = tag_of("tag36h11", 17);
            const auto fit = fitted(view, tag);
            ASSERT_TRUE(fit) << tilt << " " << turn;
            EXPECT_LT(rms(error_px(view, tag, *fit)), 0.02) << "tilt " << tilt << " turn " << turn;
        }
    }
}

TEST(TagFit, DefocusDoesNotMoveCorners) {
    for (const double blur : {0.5, 1.0, 2.0, 3.5}) {
        SyntheticView view = view_of(orbit_pose(0.45, 30, 25, 0));
        view.blur_px = blur;
        const SyntheticTag tag = tag_of("tag36h11", 5);
        const auto fit = fitted(view, tag, 1.0);
        ASSERT_TRUE(fit) << blur;
        EXPECT_LT(rms(error_px(view, tag, *fit)), 0.03) << "blur " << blur;
        // The pixel's own box is not part of the reported blur; below a pixel the two are hard to tell apart.
        EXPECT_NEAR(fit->observation.blur_px[0], blur, blur < 1 ? 0.15 : 0.05 * blur);
        EXPECT_NEAR(fit->observation.blur_px[1], blur, blur < 1 ? 0.15 : 0.05 * blur);
    }
}

TEST(TagFit, NoiseScattersCornersWithinTheirCovariance) {
    double normalised_squares = 0, squares = 0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    constexpr int trials = 24;
    for (unsigned seed = 1; seed <= trials; ++seed) {
        SyntheticView view = view_of(orbit_pose(0.6, 40, 15.0 * seed, 5));
        view.blur_px = 0.8;
        view.noise_codes = 2;
        view.seed = seed;
        const SyntheticTag tag = tag_of("tag36h11", 5);
        const auto fit = fitted(view, tag);
        ASSERT_TRUE(fit);
        const Eigen::Matrix<double, 2, 4> error = error_px(view, tag, *fit);
        squares += error.squaredNorm() / 4;
        mean += error.rowwise().mean() / trials;
        Eigen::Matrix<double, 8, 1> normalized_error;
        for (int i = 0; i < 4; ++i) {
            normalized_error.segment<2>(2 * i) = fit->observation.corners_normalized.col(i) -
                                                 view.camera.normalized_from_pixel(true_corners_px(view, tag).col(i));
        }
        const TagCovariance covariance = effective_covariance(fit->observation);
        normalised_squares += normalized_error.dot(covariance.ldlt().solve(normalized_error)) / 8;
    }
    // Two codes of noise: a few hundredths of a pixel at 80 px of side, and no bias.
    EXPECT_LT(std::sqrt(squares / trials), 0.05);
    EXPECT_LT(mean.norm(), 0.015);
    // The covariance allows for correlated errors, four pixels to an independent one, and for 0.02 px that no fit
    // knows: with independent noise a quarter of 1 is expected, a little less for the latter. Above 1 it would be too
    // small.
    EXPECT_GT(normalised_squares / trials, 0.08);
    EXPECT_LT(normalised_squares / trials, 0.5);
}

TEST(TagFit, UnevenMotionBlurKeepsTheMean) {
    // Three quarters of the exposure near one end: least squares alone would sit there. The mean displacement is zero.
    SyntheticView view = view_of(orbit_pose(0.35, 20, 10, 0));
    const Eigen::Vector2d way(2.4, 1.2);
    view.motion_px = {{-0.25 * way, 0.5}, {-0.25 * way, 0.25}, {0.75 * way, 0.25}};
    const SyntheticTag tag = tag_of("tag36h11", 9);
    const auto fit = fitted(view, tag, 0.5);
    ASSERT_TRUE(fit);
    const Eigen::Vector2d mean = error_px(view, tag, *fit).rowwise().mean();
    EXPECT_LT(mean.norm(), 0.12);  // the steepest place of the edges lies 0.67 px away
}

TEST(TagFit, AnOccluderOverAQuarterIsVotedOut) {
    SyntheticView view = view_of(orbit_pose(0.4, 30, 25, 0));
    view.blur_px = 0.7;
    const SyntheticTag tag = tag_of("tag36h11", 21);
    ImageF light = render_light(view, {tag});
    const Eigen::Matrix<double, 2, 4> corners = true_corners_px(view, tag);
    const Eigen::Vector2d middle = corners.rowwise().mean();
    for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x) {
            if (x > middle.x() && y > middle.y()) light.at(x, y) = 0.45f;
        }
    }
    const auto fit =
        fit_tag({light, 0, 0, LensGrid(view.camera), never_clipped}, tag.pattern, rough_detection(view, tag, 0.5));
    ASSERT_TRUE(fit);
    EXPECT_LT(rms(error_px(view, tag, *fit)), 0.3);
}

TEST(TagFit, ADecoyIsNoTag) {
    const SyntheticView view = view_of(orbit_pose(0.5, 30, 25, 0));
    const SyntheticTag printed = tag_of("tag36h11", 5);
    const ImageF light = render_light(view, {printed});
    // The same square with another id's cells, and the same cells turned by 90°.
    EXPECT_FALSE(fit_tag({light, 0, 0, LensGrid(view.camera), never_clipped}, TagFamily("tag36h11").pattern(6),
                         rough_detection(view, printed, 0)));
    TagDetection turned = rough_detection(view, printed, 0);
    std::rotate(turned.corners_px.begin(), turned.corners_px.begin() + 1, turned.corners_px.end());
    EXPECT_FALSE(fit_tag({light, 0, 0, LensGrid(view.camera), never_clipped}, printed.pattern, turned));
}

TEST(TagFit, AMirroredTagIsNotDetected) {
    const SyntheticView view = view_of(orbit_pose(0.5, 20, 0, 0));
    for (const std::string& family : TagFamily::names()) {
        const ImageF light = render_light(view, {tag_of(family, 2)});
        ImageF mirrored(light.width(), light.height(), 1);
        for (int y = 0; y < light.height(); ++y) {
            for (int x = 0; x < light.width(); ++x) mirrored.at(x, y) = light.at(light.width() - 1 - x, y);
        }
        const TagDetector detector(family, {});
        EXPECT_EQ(detector.detect(detection_image(light)).size(), 1u) << family;
        EXPECT_TRUE(detector.detect(detection_image(mirrored)).empty()) << family;
    }
}

TEST(TagFit, ATagInDeepShadowIsFoundWhenShadowsAreLifted) {
    // Paper at a hundredth of a sunlit ground: two of 255 linear steps, of which the thresholds keep nothing.
    SyntheticView view = view_of(orbit_pose(0.45, 35, 75, 15));
    view.paper = 0.01, view.ink = 0.0005, view.ground = 0.005;
    view.blur_px = 0.7;
    const SyntheticTag tag = tag_of("tag36h11", 4);
    ImageF light = render_light(view, {tag});
    for (int y = 0; y < 60; ++y) {
        for (float& sample : light.row(y)) sample = 1;
    }
    const TagDetector detector("tag36h11", {});
    EXPECT_TRUE(detector.detect(detection_image(light)).empty());
    const auto detections = detector.detect(detection_image(light, DetectionScale::perceptual));
    ASSERT_EQ(detections.size(), 1u);
    const auto fit = fit_tag({light, 0, 0, LensGrid(view.camera), never_clipped}, tag.pattern, detections[0]);
    ASSERT_TRUE(fit);
    EXPECT_LT(rms(error_px(view, tag, *fit)), 0.03);  // in linear light, whatever the detector saw
}

class EveryFamily : public testing::TestWithParam<std::string> {};

TEST_P(EveryFamily, IsDetectedAndRefined) {
    SyntheticView view = view_of(orbit_pose(0.45, 35, 75, 15));
    view.blur_px = 0.7;
    view.noise_codes = 2;
    const SyntheticTag tag = tag_of(GetParam(), 4);
    const ImageF light = render_light(view, {tag});
    const TagDetector detector(GetParam(), {});
    const auto detections = detector.detect(detection_image(light));
    ASSERT_EQ(detections.size(), 1u);
    EXPECT_EQ(detections[0].id, 4);
    const auto fit = fit_tag({light, 0, 0, LensGrid(view.camera), never_clipped}, tag.pattern, detections[0]);
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->observation.refined);
    EXPECT_LT(rms(error_px(view, tag, *fit)), 0.06);
}

INSTANTIATE_TEST_SUITE_P(TagFit, EveryFamily, testing::ValuesIn(TagFamily::names()),
                         [](const auto& family) { return family.param; });

TEST(LensGrid, AgreesWithNewtonsMethod) {
    const Camera camera = ordinary_camera();
    const LensGrid lens(camera);
    double worst_px = 0;
    for (double y = 0.3; y < camera.height; y += 13.7) {
        for (double x = 0.7; x < camera.width; x += 11.3) {
            const Eigen::Vector2d back = camera.pixel_from_normalized(lens.normalized_from_pixel(x, y));
            worst_px = std::max(worst_px, (back - Eigen::Vector2d(x, y)).norm());
        }
    }
    EXPECT_LT(worst_px, 1e-3);
}

}  // namespace
}  // namespace matchlight
