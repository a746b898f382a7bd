// The camera's curve from synthetic codes of paper and ink.
#include "tracking/response_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

/// Three tags whose exposure goes up and down by `range_ev` below `brightest` (light of paper), coded by `response`
/// with errors of a fifth of an 8-bit code; ink has `gloss` more light than its albedo.
std::vector<std::vector<CardReading>> clip_of(const Response& response, double range_ev, double brightest = 0.9,
                                              double gloss = 0.1) {
    std::mt19937 random(4);
    constexpr double step = 1.0 / 255;
    std::normal_distribution<double> error(0, 0.2 * step);
    std::vector<std::vector<CardReading>> readings;
    for (int f = 0; f < 100; ++f) {
        std::vector<CardReading>& frame = readings.emplace_back();
        const double exposure = brightest * std::exp2(-range_ev * (0.5 - 0.5 * std::cos(0.07 * f)));
        for (int id = 0; id < 3; ++id) {
            CardReading card;
            card.id = id;
            card.code_step = step;
            const double light = exposure * (1 - 0.04 * id);
            for (std::size_t c = 0; c < 3; ++c) {
                const double tint = c == 1 ? 1 : 0.9;
                const auto code_of = [&](double linear) {
                    return response.code_from_linear(linear, static_cast<int>(c)) + error(random);
                };
                card.paper_code[c].code = code_of(light * tint);
                card.ink_code[c].code = code_of(light * tint * (1 + gloss + 0.02 * id) / 20);
                card.paper_code[c].standard_error = card.ink_code[c].standard_error = 0.2 * step;
                card.paper_code[c].clipped = card.paper_code[c].code >= 0.98;
            }
            frame.push_back(card);
        }
    }
    return readings;
}

TEST(ResponseFit, LeavesSrgbWhereItHolds) {
    for (const double gloss : {0.0, 0.2}) {
        const ResponseFit fit = fit_response(clip_of(Response::srgb(), 1.5, 0.9, gloss), 20);
        EXPECT_TRUE(fit.told);
        EXPECT_EQ(fit.response.family(), Response::Family::srgb);
        EXPECT_NEAR(fit.exposure_range_ev, 1.5, 0.1);
    }
}

TEST(ResponseFit, FindsAnExponent) {
    for (const double gamma : {1.7, 2.6}) {
        const ResponseFit fit = fit_response(clip_of(Response::gamma(gamma), 1.5), 20);
        EXPECT_TRUE(fit.told);
        ASSERT_EQ(fit.response.family(), Response::Family::gamma) << gamma;
        // Ratios do not tell the overall exponent; the albedos do, within what gloss does to them.
        EXPECT_NEAR(std::log(fit.response.linear_from_code(0.5, 1)) / std::log(0.5), gamma, 0.05 * gamma);
    }
}

TEST(ResponseFit, ScatterDoesNotFavourSmallExponents) {
    auto readings = clip_of(Response::gamma(1.8), 1.5);
    std::mt19937 random(9);
    std::normal_distribution<double> gloss(0, 0.015);  // of ink's code: 2.7 % of its light, from view to view
    for (auto& frame : readings) {
        for (CardReading& card : frame) {
            for (CardCode& ink : card.ink_code) ink.code *= 1 + gloss(random);
        }
    }
    const ResponseFit fit = fit_response(readings, 20);
    ASSERT_EQ(fit.response.family(), Response::Family::gamma);
    EXPECT_NEAR(std::log(fit.response.linear_from_code(0.5, 1)) / std::log(0.5), 1.8, 0.05 * 1.8);
}

TEST(ResponseFit, FindsAShoulder) {
    const Response truth = Response::shoulder({.knee = 0.3}, "test");
    const ResponseFit fit = fit_response(clip_of(truth, 2, 1.1), 20);
    EXPECT_TRUE(fit.told);
    ASSERT_EQ(fit.response.family(), Response::Family::shoulder);
    for (const double code : {0.3, 0.6, 0.8, 0.95}) {
        EXPECT_NEAR(fit.response.linear_from_code(code, 1) / truth.linear_from_code(code, 1), 1, 0.05) << code;
    }
}

TEST(ResponseFit, SaysWhenExposureDoesNotChangeEnough) {
    const ResponseFit fit = fit_response(clip_of(Response::gamma(1.7), 0.2), 20);
    EXPECT_FALSE(fit.told);
    EXPECT_EQ(fit.response.family(), Response::Family::srgb);
    EXPECT_FALSE(fit_response({{}, {}}, 20).told);
}

}  // namespace
}  // namespace matchlight
