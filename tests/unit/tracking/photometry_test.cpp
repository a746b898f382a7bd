// Exposure and white balance from synthetic readings and from a drawn card.
#include "tracking/photometry.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

#include "core/transfer.h"
#include "media/av_pointers.h"
#include "media/plate_format.h"
#include "synthetic_view.h"
#include "tracking/grey_card.h"

namespace matchlight {
namespace {

constexpr std::array<double, 3> expected_light{1.2, 1.0, 0.7};  // paper minus ink at exposure 0

std::map<int, CardExpectation> cards(int count) {
    std::map<int, CardExpectation> expected;
    for (int id = 0; id < count; ++id) {
        expected[id].difference = expected_light;
        for (std::size_t c = 0; c < 3; ++c) expected[id].ink[c] = expected_light[c] * 0.04 / 0.76;
    }
    return expected;
}

struct Truth {
    double ev = 0;
    std::array<double, 3> white_balance{1.06, 1, 0.93};
    double light_on_tag = 1;  // of the light at the probe
    bool clipped = false;
};

CardReading reading(int id, const Truth& truth, double noise = 0) {
    CardReading card;
    card.id = id;
    for (std::size_t c = 0; c < 3; ++c) {
        const double light =
            expected_light[c] * std::exp2(truth.ev) * truth.white_balance[c] * truth.light_on_tag * (1 + noise);
        card.difference[c] = {light, 0.005, !truth.clipped};
        card.ink[c] = {light * 0.04 / 0.76 * 1.3, 0.03, true};  // 30 % of gloss on top
    }
    return card;
}

TEST(Photometry, RecoversExposureAndWhiteBalance) {
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 20; ++f) readings.push_back({reading(0, {0.1 * f - 1}), reading(1, {0.1 * f - 1})});
    const ClipPhotometry clip = solve_photometry(readings, cards(2), false);
    for (int f = 0; f < 20; ++f) {
        const auto& frame = clip.frames[static_cast<std::size_t>(f)];
        ASSERT_TRUE(frame);
        EXPECT_NEAR(frame->exposure_ev, 0.1 * f - 1, 1e-6);
        EXPECT_NEAR(frame->white_balance[0], 1.06, 1e-6);
        EXPECT_EQ(frame->white_balance[1], 1);
        EXPECT_NEAR(frame->white_balance[2], 0.93, 1e-6);
        EXPECT_GT(frame->confidence, 0.8);
    }
}

TEST(Photometry, ATagInShadowMovesNothing) {
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 30; ++f) {
        Truth lit, shaded;
        shaded.light_on_tag = f >= 10 ? 0.4 : 1;  // a hand's shadow falls on tag 2 and stays
        readings.push_back({reading(0, lit), reading(1, lit), reading(2, shaded)});
    }
    const ClipPhotometry clip = solve_photometry(readings, cards(3), false);
    for (const auto& frame : clip.frames) {
        ASSERT_TRUE(frame);
        EXPECT_NEAR(frame->exposure_ev, 0, 0.02);
    }
    EXPECT_NEAR(clip.frames[9]->exposure_ev, clip.frames[10]->exposure_ev, 0.02);
}

TEST(Photometry, TagsThatComeAndGoMakeNoJump) {
    // Tag 1 always gets a fifth less light; it leaves the frame half way.
    Truth dim;
    dim.light_on_tag = 0.8;
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 30; ++f) {
        readings.push_back({reading(0, {})});
        if (f < 15) readings.back().push_back(reading(1, dim));
    }
    const ClipPhotometry clip = solve_photometry(readings, cards(2), false);
    EXPECT_NEAR(clip.frames[14]->exposure_ev, clip.frames[15]->exposure_ev, 0.005);
}

TEST(Photometry, AStepIsFollowedWithoutDelay) {
    std::mt19937 random(2);
    std::normal_distribution<double> noise(0, 0.003);
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 20; ++f) readings.push_back({reading(0, {f < 10 ? 0.0 : -1.0}, noise(random))});
    const ClipPhotometry clip = solve_photometry(readings, cards(1), false);
    EXPECT_NEAR(clip.frames[9]->exposure_ev, 0, 0.02);
    EXPECT_NEAR(clip.frames[10]->exposure_ev, -1, 0.02);
}

TEST(Photometry, InkFollowsWherePaperIsClipped) {
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 30; ++f) {
        Truth truth;
        truth.ev = 0.05 * f;
        truth.clipped = f >= 15;
        readings.push_back({reading(0, truth), reading(1, truth)});
    }
    const ClipPhotometry clip = solve_photometry(readings, cards(2), false);
    for (int f = 15; f < 30; ++f) {
        EXPECT_NEAR(clip.frames[static_cast<std::size_t>(f)]->exposure_ev, 0.05 * f, 0.02) << f;
    }
    EXPECT_LT(clip.frames[20]->confidence, clip.frames[5]->confidence);
}

TEST(Photometry, WithoutAProbeTheFirstFrameIsZero) {
    std::vector<std::vector<CardReading>> readings{{}, {reading(0, {-2.0})}, {reading(0, {-1.5})}};
    std::map<int, CardExpectation> unknown;
    unknown[0] = {};
    const ClipPhotometry clip = solve_photometry(readings, unknown, true);
    EXPECT_NEAR(clip.frames[1]->exposure_ev, 0, 1e-9);
    EXPECT_NEAR(clip.frames[2]->exposure_ev, 0.5, 1e-6);
    EXPECT_LT(clip.frames[0]->confidence, 0.5);  // held from the next
}

TEST(Photometry, NothingSeenIsNothingKnown) {
    const ClipPhotometry clip = solve_photometry({{}, {}}, cards(1), false);
    EXPECT_FALSE(clip.frames[0]);
    EXPECT_FALSE(clip.frames[1]);
}

/// An 8-bit picture of a lit card as a frame of footage.
PlateFrame photographed(const ImageF& albedo, const std::array<double, 3>& light) {
    std::shared_ptr<AVFrame> samples = allocated_frame(albedo.width(), albedo.height(), AV_PIX_FMT_RGB24);
    for (int y = 0; y < albedo.height(); ++y) {
        for (int x = 0; x < albedo.width(); ++x) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double code = srgb_code_from_linear(albedo.at(x, y) * light[c]);
                samples->data[0][y * samples->linesize[0] + 3 * x + static_cast<int>(c)] =
                    static_cast<std::uint8_t>(std::lround(255 * std::min(code, 1.0)));
            }
        }
    }
    PlateFormat format = plate_format_of(*samples, 0, {}, "card.png");
    return {std::move(samples), std::move(format), 0, 0};
}

TEST(GreyCard, ReadsPaperMinusInk) {
    test::SyntheticView view;
    view.camera = test::ordinary_camera();
    view.camera_from_world = test::orbit_pose(0.4, 35, 20, 0);
    view.paper = 0.8, view.ink = 0.04, view.blur_px = 0.8;
    test::SyntheticTag tag;
    tag.pattern = TagFamily("tag36h11").pattern(3);
    const ImageF albedo = test::render_light(view, {tag});
    const LensGrid lens(view.camera);
    const auto fit = fit_tag({albedo, 0, 0, lens, 2}, tag.pattern, test::rough_detection(view, tag, 0.5));
    ASSERT_TRUE(fit);
    const std::array<double, 3> light{0.9, 0.8, 0.5};
    const PlateFrame frame = photographed(albedo, light);
    const PlateLight plate_light(Response::srgb(), frame.format().transfer);
    const auto card = read_card(frame, plate_light, lens, tag.pattern, *fit);
    ASSERT_TRUE(card);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_TRUE(card->difference[c].usable);
        // 8-bit codes of paper are 0.9 % apart in light, so a mean of equal pixels may be off by half of that.
        EXPECT_NEAR(card->difference[c].light, 0.76 * light[c], 0.006 * light[c]);
        EXPECT_NEAR(card->ink[c].light, 0.04 * light[c], 0.002);
    }
    // Overexposed in red: that channel only bounds the light from below.
    const auto bright = read_card(photographed(albedo, {1.4, 0.8, 0.5}), plate_light, lens, tag.pattern, *fit);
    ASSERT_TRUE(bright);
    EXPECT_FALSE(bright->difference[0].usable);
    EXPECT_TRUE(bright->difference[1].usable);
    EXPECT_TRUE(bright->ink[0].usable);
}

}  // namespace
}  // namespace matchlight
