// The reference renderer of tags against places, blurs and noise that are known in closed form.
#include "report/tag_view_reference.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tracking/tag_fit.h"

namespace matchlight {
namespace {

constexpr double distance_m = 0.5;

Camera pinhole() {
    Camera camera;
    camera.width = 200, camera.height = 160;
    camera.fx = 400, camera.fy = 404, camera.cx = 98.37, camera.cy = 81.21;
    return camera;
}

/// A camera `shift_m` beside the place straight above the origin.
RigidTransform above(const Eigen::Vector2d& shift_m = {0, 0}) {
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    pose.translation() = Eigen::Vector3d(shift_m.x(), shift_m.y(), distance_m);
    return pose;
}

TagView tag_below(const Eigen::Vector2d& shift_m = {0, 0}) {
    TagView view;
    view.camera = pinhole();
    view.camera_from_world = [=](double) { return above(shift_m); };
    TagSheet tag;
    tag.pattern = TagFamily("tag36h11").pattern(0);
    tag.size_m = 0.1;
    view.tags.push_back(tag);
    return view;
}

/// Pixels of ink over a part of a row or column, as an area: where an edge lies, but for whole pixels.
double ink_along(const ImageF& light, bool row, int line, int from, int to) {
    double ink = 0;
    for (int i = from; i < to; ++i) ink += (0.8 - (row ? light.at(i, line) : light.at(line, i))) / 0.75;
    return ink;
}

constexpr int half_cell_px = 5;

/// The outer left or top edge of the border, which is a cell of 10 px wide: mean over the lines that cross it well
/// away from its corners.
double outer_edge(const ImageF& light, const TagView& view, bool left) {
    const Eigen::Matrix<double, 2, 4> corners = reference_corners_px(view, view.tags[0]);
    const int along = left ? 1 : 0, across = left ? 0 : 1;
    const int first = static_cast<int>(corners(along, 3)) + 14, last = first + 50;
    const int inner = static_cast<int>(corners(across, 3)) + half_cell_px;
    double sum = 0;
    for (int line = first; line < last; ++line) {
        sum += inner - 0.5 - ink_along(light, left, line, inner - 2 * half_cell_px, inner);
    }
    return sum / (last - first);
}

void expect_edges_where_they_are(const TagView& view) {
    const ImageF light = reference_light(view);
    const Eigen::Matrix<double, 2, 4> corners = reference_corners_px(view, view.tags[0]);
    EXPECT_NEAR(outer_edge(light, view, true), corners(0, 3), 0.005);
    EXPECT_NEAR(outer_edge(light, view, false), corners(1, 3), 0.005);
}

TEST(TagViewReference, EdgesLieWhereTheyAre) {
    for (const double shift_px : {0.0, 0.13, 0.5, 0.77}) {
        const double shift_m = shift_px / 400 * distance_m;
        expect_edges_where_they_are(tag_below({shift_m, 0.6 * shift_m}));
    }
}

TEST(TagViewReference, MotionBlurLeavesEdgesAtMidExposure) {
    TagView view = tag_below();
    view.exposure_s = 0.01;
    // 8 px to the right and 4.8 px down.
    view.camera_from_world = [](double time_s) {
        return above(Eigen::Vector2d(1, 0.6) * (8 / 400.0 * distance_m * time_s / 0.01));
    };
    expect_edges_where_they_are(view);
}

TEST(TagViewReference, DefocusIsADiscOfTheCircleOfConfusion) {
    TagView view = tag_below();
    view.focus_distance_m = 0.4;
    constexpr double diameter_px = 7;
    view.aperture_m = diameter_px / (view.camera.fx * (1 / 0.4 - 1 / distance_m));
    expect_edges_where_they_are(view);
    // The light's step across the edge is the disc's projection; its variance is a quarter of the radius squared. The
    // pixel's box and the difference of two pixels add a twelfth each.
    const ImageF light = reference_light(view);
    const Eigen::Matrix<double, 2, 4> corners = reference_corners_px(view, view.tags[0]);
    double sum = 0, variance = 0;
    const double edge = corners(0, 3);
    const int first = static_cast<int>(corners(1, 3)) + 14;
    for (int line = first; line < first + 50; ++line) {
        for (int x = static_cast<int>(edge) - 5; x < static_cast<int>(edge) + 5; ++x) {
            const double step = light.at(x, line) - light.at(x + 1, line), at = x + 0.5 - edge;
            sum += step;
            variance += step * at * at;
        }
    }
    EXPECT_NEAR(variance / sum, diameter_px * diameter_px / 16 + 2.0 / 12, 0.03);
}

TEST(TagViewReference, BlurNeitherTakesNorAddsLight) {
    TagView view = tag_below();
    view.ground = 0;
    const auto total = [](const ImageF& light) {
        double sum = 0;
        for (const float sample : light.samples()) sum += sample;
        return sum;
    };
    const double sharp = total(reference_light(view));
    view.focus_distance_m = 0.4;
    view.aperture_m = 10 / (view.camera.fx * 0.5);
    view.exposure_s = 0.01;
    view.camera_from_world = [](double time_s) { return above({time_s * 0.5, 0}); };
    EXPECT_NEAR(total(reference_light(view)) / sharp, 1, 5e-4);
}

TEST(TagViewReference, RollingShutterExposesRowsOneAfterTheOther) {
    TagView view = tag_below();
    view.readout_s = 0.02;
    view.camera_from_world = [](double time_s) { return above({time_s * 0.5, 0}); };  // 400 px/s
    EXPECT_DOUBLE_EQ(row_time_s(view, 0), -0.01);
    EXPECT_DOUBLE_EQ(row_time_s(view, 159), 0.01);
    const Eigen::Matrix<double, 2, 4> corners = reference_corners_px(view, view.tags[0]);
    // The upper corners are exposed 80 rows, 0.01006 s, before the lower ones.
    EXPECT_NEAR((corners(0, 0) - corners(0, 3)) / (corners(1, 0) - corners(1, 3)), 400 * 0.02 / 159, 1e-9);
    const ImageF light = reference_light(view);
    // The outer left edge of a row at the middle of the border's left side.
    for (const int line : {60, 81, 100}) {
        const double edge = corners(0, 3) + (line - corners(1, 3)) * 400 * 0.02 / 159;
        const int inner = static_cast<int>(edge + 6);  // inside the border's cell, 10 px wide
        EXPECT_NEAR(inner - 0.5 - ink_along(light, true, line, static_cast<int>(edge) - 6, inner), edge, 0.005);
    }
}

TEST(TagViewReference, AgreesWithTheFitThroughALens) {
    TagView view = tag_below();
    view.camera.distortion = {-0.12, 0.05, 0.002, -0.001, 0.01};
    const RigidTransform tilted = RigidTransform(rotation_from_degrees({35, 10, 20}));
    view.camera_from_world = [=](double) { return above() * tilted; };
    const Eigen::Matrix<double, 2, 4> corners = reference_corners_px(view, view.tags[0]);
    TagDetection rough;
    for (int i = 0; i < 4; ++i) {
        rough.corners_px[static_cast<std::size_t>(i)] = corners.col(i) + Eigen::Vector2d(0.4 * i - 0.6, 0.3);
    }
    constexpr double never_clipped = 2;
    const auto fit =
        fit_tag({reference_light(view), 0, 0, LensGrid(view.camera), never_clipped}, view.tags[0].pattern, rough);
    ASSERT_TRUE(fit);
    EXPECT_LT((fit->observation.corners_px - corners).cwiseAbs().maxCoeff(), 0.01);
}

TEST(TagViewReference, ANearerCardHidesATag) {
    TagView view = tag_below();
    HidingCard card;
    card.width_m = 0.02, card.height_m = 0.2;
    card.world_from_card.translation() = Eigen::Vector3d(0.02, 0, 0.05);
    view.cards.push_back(card);
    const Eigen::Vector2d on_card = view.camera.pixel_from_camera(above() * Eigen::Vector3d(0.02, 0, 0.05));
    const auto at = [&](const ImageF& light) {
        return light.at(static_cast<int>(std::lround(on_card.x())), static_cast<int>(std::lround(on_card.y())));
    };
    EXPECT_FLOAT_EQ(at(reference_light(view)), 0.2f);
    view.cards[0].world_from_card.translation().z() = -0.05;
    EXPECT_NE(at(reference_light(view)), 0.2f);
}

TEST(TagViewReference, RecordingCodesLightAndAddsItsNoise) {
    const ImageF light(300, 200, 1, 0.25f);
    Recording recording;
    recording.exposure_ev = -1;
    recording.white_balance = {1.2, 1, 0.8};
    recording.vignette = {-0.2, 0.05};
    const Image8 clean = recorded_picture(light, recording);
    const auto back = [&](int x, int y) { return recording.response.linear_from_code(clean.at(x, y, 1) / 255.0, 1); };
    EXPECT_NEAR(back(150, 100), 0.125, 0.001);
    EXPECT_NEAR(back(0, 0), 0.125 * 0.85, 0.001);
    const PlateFrame frame = recorded_frame(clean, 5, 0.2);
    EXPECT_EQ(frame.index(), 5);
    EXPECT_NEAR(frame.rgb_code({150, 100, 1, 1}).at(0, 0, 2), clean.at(150, 100, 2) / 255.0, 1e-6);
    EXPECT_GT(clean.at(150, 100, 0), clean.at(150, 100, 1));

    recording = {};
    recording.read_noise = 0.01;
    recording.shot_noise = 0.001;
    const Image8 noisy = recorded_picture(light, recording);
    double sum = 0, squares = 0;
    constexpr int count = 300 * 200;
    for (int i = 0; i < count; ++i) {
        const double value =
            recording.response.linear_from_code(noisy.samples()[static_cast<std::size_t>(3 * i)] / 255.0, 0);
        sum += value, squares += value * value;
    }
    const double mean = sum / count, variance = squares / count - mean * mean;
    EXPECT_NEAR(mean, 0.25, 0.001);
    EXPECT_NEAR(variance / (0.01 * 0.01 + 0.001 * 0.25), 1, 0.03);
    EXPECT_EQ(std::vector<std::uint8_t>(noisy.samples().begin(), noisy.samples().end()), [&] {
        const Image8 again = recorded_picture(light, recording);
        return std::vector<std::uint8_t>(again.samples().begin(), again.samples().end());
    }());
}

}  // namespace
}  // namespace matchlight
