// Exposure, white balance, fall-off and gradient of light from synthetic readings.
#include "tracking/photometry.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

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

TEST(Photometry, BluePaperLeadsWhereGreenIsClipped) {
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 40; ++f) {
        Truth truth;
        truth.ev = 0.02 * f;
        readings.push_back({reading(0, truth), reading(1, truth)});
        for (CardReading& card : readings.back()) {
            card.difference[0].usable = card.difference[1].usable = f < 20;
            // Ink drifts by a twelfth meanwhile: it must not be believed while paper is seen in any channel.
            for (CardLight& ink : card.ink) ink.light *= 1 + 0.002 * f;
        }
    }
    const ClipPhotometry clip = solve_photometry(readings, cards(2), false);
    for (int f = 0; f < 40; ++f) {
        EXPECT_NEAR(clip.frames[static_cast<std::size_t>(f)]->exposure_ev, 0.02 * f, 0.002) << f;
        EXPECT_NEAR(clip.frames[static_cast<std::size_t>(f)]->white_balance[0], 1.06, 0.002) << f;
    }
}

TEST(Photometry, WhiteBalanceIsSteadyButJumpsWhenItDoes) {
    std::mt19937 random(5);
    std::normal_distribution<double> shake(0, 0.004);
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 60; ++f) {
        Truth truth;
        truth.white_balance[2] = f < 30 ? 0.93 : 1.05;
        readings.push_back({reading(0, truth), reading(1, truth)});
        const double chroma = std::exp(shake(random));  // coding shifts the chroma of all tags in a frame
        for (CardReading& card : readings.back()) card.difference[2].light *= chroma;
    }
    const ClipPhotometry clip = solve_photometry(readings, cards(2), false);
    for (std::size_t f = 0; f < 60; ++f) {
        EXPECT_NEAR(clip.frames[f]->white_balance[2], f < 30 ? 0.93 : 1.05, 0.006) << f;
        if (f == 0 || f == 30) continue;
        EXPECT_NEAR(clip.frames[f]->white_balance[2], clip.frames[f - 1]->white_balance[2], 0.005) << f;
    }
}

double fall_off(double radius) {
    return 1 - 0.25 * radius * radius - 0.1 * std::pow(radius, 4);
}

TEST(Photometry, FallOffIsNoChangeOfExposure) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.003);
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 80; ++f) {
        std::vector<CardReading>& frame = readings.emplace_back();
        for (int id = 0; id < 3; ++id) {
            Truth truth;
            truth.ev = 0.3 * std::sin(0.1 * f);
            truth.light_on_tag = 1 + 0.05 * id;
            const double radius = std::abs(std::sin(0.05 * f + id));
            if (radius > 0.95) continue;  // outside
            truth.light_on_tag *= fall_off(radius);
            frame.push_back(reading(id, truth, noise(random)));
            frame.back().radius = radius;
        }
    }
    const ClipPhotometry clip = solve_photometry(readings, cards(3), false);
    ASSERT_TRUE(clip.vignette);
    for (const double radius : {0.3, 0.6, 1.0}) {
        const double r2 = radius * radius;
        EXPECT_NEAR(1 + clip.vignette->gain[0] * r2 + clip.vignette->gain[1] * r2 * r2, fall_off(radius), 0.02);
    }
    EXPECT_LT(clip.vignette->corner_sigma, 0.05);
    const double scale = clip.frames[0]->exposure_ev;
    for (int f = 0; f < 80; ++f) {
        const auto& frame = clip.frames[static_cast<std::size_t>(f)];
        if (!frame->measured) continue;
        EXPECT_NEAR(frame->exposure_ev - scale, 0.3 * std::sin(0.1 * f), 0.01) << f;
    }
}

TEST(Photometry, FallOffIsNotKnownFromTagsThatStayWhereTheyAre) {
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 60; ++f) {
        readings.push_back({reading(0, {0.01 * f}), reading(1, {0.01 * f})});
        readings.back()[0].radius = 0.1;
        readings.back()[1].radius = 0.5 + 0.02 * std::sin(0.1 * f);
    }
    EXPECT_FALSE(solve_photometry(readings, cards(2), false).vignette);
}

TEST(Photometry, LightThatChangesOverTheTableIsAGradient) {
    const std::array<Eigen::Vector3d, 4> places{
        Eigen::Vector3d(0.05, 0, 0), {-0.15, 0, 0}, {0.15, 0.02, 0}, {0, 0.2, 0}};
    const Eigen::Vector3d gradient_ev_per_m(0.8, -0.5, 0);
    std::map<int, CardExpectation> expected = cards(4);
    for (int id = 0; id < 4; ++id) expected[id].place_m = places[static_cast<std::size_t>(id)];
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 40; ++f) {
        std::vector<CardReading>& frame = readings.emplace_back();
        for (int id = 0; id < 4; ++id) {
            if ((f / 10) % 4 == id) continue;  // each is away for a while
            Truth truth;
            truth.light_on_tag = std::exp2(gradient_ev_per_m.dot(places[static_cast<std::size_t>(id)]));
            frame.push_back(reading(id, truth));
        }
    }
    const ClipPhotometry clip = solve_photometry(readings, expected, false);
    ASSERT_TRUE(clip.light_gradient_ev_per_m);
    EXPECT_LT((*clip.light_gradient_ev_per_m - gradient_ev_per_m).norm(), 0.05);
    for (const auto& frame : clip.frames) EXPECT_NEAR(frame->exposure_ev, 0, 0.01);  // at place 0, no tag's own
}

TEST(Photometry, WhatTheProbeShowsOfATagComesBeforeItsAlbedo) {
    std::map<int, CardExpectation> expected = cards(2);
    expected[0].shown_difference = expected_light;
    for (double& light : *expected[0].shown_difference) light *= 0.9;  // grey paper, in less light
    expected[0].weight = 10;
    Truth grey;
    grey.light_on_tag = 0.9;
    const ClipPhotometry clip = solve_photometry({{reading(0, grey), reading(1, {})}}, expected, false);
    EXPECT_NEAR(clip.frames[0]->exposure_ev, 0, 0.002);
}

}  // namespace
}  // namespace matchlight
