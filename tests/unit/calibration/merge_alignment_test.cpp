// Motions of synthetic hand-held photographs found again.
#include "calibration/merge_alignment.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calibration/hdr_merge.h"
#include "report/synthetic_bracket.h"

namespace matchlight {
namespace {

constexpr int width = 480, height = 360;

/// Light of some six stops with detail of many sizes, at any place of the plane.
double scene_light(double x, double y) {
    const double waves = std::sin(0.043 * x + 0.021 * y) + std::sin(0.017 * x - 0.061 * y) +
                         0.6 * std::sin(0.21 * x + 0.13 * y) + 0.4 * std::sin(0.11 * x - 0.37 * y);
    return 0.1 * std::exp2(waves);
}

/// What a camera that moved sees: the reference's x stands at R(angle)·(x − c) + c + shift in it.
ImageF seen_by(const PhotographMotion& motion) {
    ImageF radiance(width, height, 3);
    const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1);
    const double c = std::cos(motion.angle_rad), s = std::sin(motion.angle_rad);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double dx = x - cx - motion.right_px, dy = y - cy - motion.down_px;
            const double light = scene_light(c * dx + s * dy + cx, -s * dx + c * dy + cy);
            for (int channel = 0; channel < 3; ++channel) radiance.at(x, y, channel) = static_cast<float>(light);
        }
    }
    return radiance;
}

class MergeAlignment : public testing::Test {
protected:
    MergeAlignment() { warnings_.set_quiet(true); }
    ExposureSeries photographs(const std::vector<PhotographMotion>& motions) const {
        const std::vector<double> exposures = {4, 1, 0.25};
        ExposureSeries series = photographed(seen_by({}), exposures, camera_);
        for (std::size_t i = 0; i < motions.size(); ++i)
            series.shots[i].code = photographed(seen_by(motions[i]), exposures, camera_).shots[i].code;
        return series;
    }
    /// Root mean square of EV in the inner part, of green.
    static double error_ev(const MergedPhotograph& merged, const PhotographMotion& reference) {
        const ImageF truth = seen_by(reference);
        double sum = 0;
        int count = 0;
        for (int y = 30; y < height - 30; ++y) {
            for (int x = 30; x < width - 30; ++x) {
                const double off = std::log2(merged.radiance.at(x, y, 1) / truth.at(x, y, 1));
                sum += off * off;
                ++count;
            }
        }
        return std::sqrt(sum / count);
    }
    SyntheticCamera camera_;
    Warnings warnings_;
};

TEST_F(MergeAlignment, PhotographsFromATripodStayAsTheyAre) {
    const ExposureSeries series = photographs({{}, {}, {}});
    const MergedPhotograph merged = merge_exposures(series, Response::srgb(), {}, warnings_);
    for (const auto& motion : merged.motions) EXPECT_FALSE(motion.has_value());
}

TEST_F(MergeAlignment, HandHeldPhotographsAreMovedOntoTheReference) {
    const std::vector<PhotographMotion> motions = {{3.4, -2.2, 0.004}, {}, {-5.7, 4.1, -0.006}};
    const ExposureSeries series = photographs(motions);
    const MergedPhotograph merged = merge_exposures(series, Response::srgb(), {}, warnings_);
    ASSERT_EQ(merged.reference, 1u);
    for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
        SCOPED_TRACE(i);
        ASSERT_TRUE(merged.motions[i].has_value());
        // A fifth of a pixel at the corners, 300 pixels from the centre. Half of the longest exposure is full.
        EXPECT_NEAR(merged.motions[i]->right_px, motions[i].right_px, 0.1);
        EXPECT_NEAR(merged.motions[i]->down_px, motions[i].down_px, 0.1);
        EXPECT_NEAR(merged.motions[i]->angle_rad, motions[i].angle_rad, 0.0005);
    }
    EXPECT_FALSE(merged.motions[1].has_value());
    const MergedPhotograph still = merge_exposures(photographs({{}, {}, {}}), Response::srgb(), {}, warnings_);
    const MergedPhotograph unmoved =
        merge_exposures(series, Response::srgb(), {.align = Alignment::off, .deghost = false}, warnings_);
    EXPECT_LT(error_ev(merged, {}), 1.3 * error_ev(still, {}));
    EXPECT_GT(error_ev(unmoved, {}), 4 * error_ev(merged, {}));
}

TEST_F(MergeAlignment, FullPixelsStayFullAndTheOutsideCountsAsFull) {
    ImageF code(40, 30, 3, 0.5f);
    code.at(20, 15, 1) = 1;
    const CodeTable table(Response::srgb(), false, 1.0 / 255);
    const ImageF moved = moved_codes(code, {2.5, 0, 0}, table, {1, 1, 1});
    // The reference's x shows what lies 2.5 pixels further right.
    EXPECT_EQ(moved.at(17, 15, 1), outside_code);
    EXPECT_EQ(moved.at(18, 15, 1), outside_code);
    EXPECT_NEAR(moved.at(18, 15, 0), 0.5, 1e-3);
    EXPECT_NEAR(moved.at(10, 15, 1), 0.5, 1e-3);
    EXPECT_EQ(moved.at(39, 15, 0), outside_code);
    EXPECT_NEAR(moved.at(0, 15, 0), 0.5, 1e-3);
}

TEST_F(MergeAlignment, NothingToSeeIsNoMotion) {
    for (const float light : {0.0f, 0.2f, 1e6f}) {
        const ExposureSeries series = photographed(ImageF(64, 64, 3, light), {4, 1, 0.25}, camera_);
        const MergedPhotograph merged =
            merge_exposures(series, Response::srgb(), {.align = Alignment::automatic}, warnings_);
        for (const auto& motion : merged.motions) EXPECT_FALSE(motion.has_value()) << light;
    }
}

TEST_F(MergeAlignment, ASlopeOfLightIsNoMotion) {
    // Noise that ends at black and full makes the steps between exposures look shorter, as sliding along the slope
    // does.
    const SyntheticCamera noisy{.read_noise = 0.05, .shot_noise = 0.02};
    const ExposureSeries series = photographed(radiance_ramp(512, 128, 10), {0.25, 1, 4, 16, 64}, noisy);
    const MergedPhotograph merged = merge_exposures(series, noisy.response, {}, warnings_);
    for (const auto& motion : merged.motions) EXPECT_FALSE(motion.has_value());
}

}  // namespace
}  // namespace matchlight
