// A clip's readings made from known exposures and tags: what a calibration makes of them.
#include "tracking/probe_calibration.h"

#include <cmath>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

/// Three tags over four frames, whose exposure falls by 0.1 EV a frame from −1; each tag's light is off by `tag_ev`.
struct MadeClip {
    Solve solve;
    TrackDetails details;

    explicit MadeClip(const std::array<double, 3>& tag_ev) {
        for (int id = 0; id < 3; ++id) {
            CardExpectation expected;
            expected.difference = {0.5, 0.4, 0.3};
            details.expected_cards[id] = expected;
        }
        for (int f = 0; f < 4; ++f) {
            SolvedFrame frame;
            frame.frame = f;
            frame.exposure_ev = -1 - 0.1 * f;
            frame.white_balance = {1.1, 1, 0.9};
            solve.frames.push_back(frame);
            FrameObservations observed;
            observed.frame = f;
            details.observations.push_back(observed);
            std::vector<CardReading> cards;
            for (int id = 0; id < 3; ++id) {
                CardReading card;
                card.id = id;
                for (std::size_t c = 0; c < 3; ++c) {
                    const double light = details.expected_cards[id].difference[c] * (*frame.white_balance)[c] *
                                         std::exp2(*frame.exposure_ev + tag_ev.at(static_cast<std::size_t>(id)));
                    card.difference[c] = {light, 0.005, true};
                }
                cards.push_back(card);
            }
            details.cards.push_back(cards);
        }
    }
};

TEST(ProbeCalibration, IsTheFramesMedianAndItsChannels) {
    const MadeClip clip({0, 0, 0});
    const auto found = calibrate_probe(clip.solve, clip.details, std::nullopt);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->frames, 4);
    EXPECT_NEAR(found->exposure_ev, -1.15, 0.051);  // the upper of the two in the middle
    EXPECT_NEAR(found->least_ev, -1.3, 1e-9);
    EXPECT_NEAR(found->most_ev, -1, 1e-9);
    EXPECT_NEAR(found->channel_ev[0] - found->channel_ev[1], std::log2(1.1), 1e-9);
    EXPECT_NEAR(found->channel_ev[2] - found->channel_ev[1], std::log2(0.9), 1e-9);
    ASSERT_EQ(found->tags.size(), 3u);
    for (const CalibratedTag& tag : found->tags) {
        EXPECT_NEAR(tag.deviation_ev[1], 0, 1e-9);
        EXPECT_NEAR(tag.scatter_ev, 0, 1e-9);
        EXPECT_FALSE(tag.out_of_line);
    }
    const auto last = calibrate_probe(clip.solve, clip.details, 3);
    ASSERT_TRUE(last);
    EXPECT_NEAR(last->exposure_ev, -1.3, 1e-9);
    EXPECT_FALSE(calibrate_probe(clip.solve, clip.details, 7));
}

TEST(ProbeCalibration, ATagUnderOtherLightIsToldAndWidensTheSigma) {
    const MadeClip even({0, 0.05, -0.05});
    const MadeClip shadowed({0, 0.05, -0.5});
    const auto good = calibrate_probe(even.solve, even.details, std::nullopt);
    const auto bad = calibrate_probe(shadowed.solve, shadowed.details, std::nullopt);
    ASSERT_TRUE(good && bad);
    EXPECT_FALSE(good->tags[2].out_of_line);
    EXPECT_FALSE(bad->tags[1].out_of_line);
    EXPECT_TRUE(bad->tags[2].out_of_line);
    EXPECT_NEAR(bad->tags[2].mean_deviation_ev, -0.5, 1e-9);
    EXPECT_GT(bad->channel_sigma[1], 3 * good->channel_sigma[1]);
}

TEST(ProbeCalibration, WhatTheProbeShowsIsTrustedMore) {
    MadeClip clip({0, 0, 0.15});
    EXPECT_FALSE(calibrate_probe(clip.solve, clip.details, std::nullopt)->tags[2].out_of_line);
    clip.details.expected_cards[2].shown_difference = clip.details.expected_cards[2].difference;
    EXPECT_TRUE(calibrate_probe(clip.solve, clip.details, std::nullopt)->tags[2].out_of_line);
}

}  // namespace
}  // namespace matchlight
