// Random numbers of grain: known words, exact moments, correlations as asked.
#include "render/effects/grain_noise.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(GrainNoiseTest, QuantilesAreANormalDistribution) {
    const std::vector<float> values = grain_quantiles();
    ASSERT_EQ(values.size(), std::size_t{1} << grain_quantile_bits);
    double sum = 0, squares = 0, fourth = 0;
    for (const float value : values) {
        sum += value;
        squares += std::pow(value, 2);
        fourth += std::pow(value, 4);
    }
    const double count = static_cast<double>(values.size());
    EXPECT_NEAR(sum / count, 0, 1e-9);
    EXPECT_NEAR(squares / count, 1, 1e-6);
    EXPECT_NEAR(fourth / count, 3,
                0.02);  // of a normal distribution 3; the outermost 1/8192 at either end are one value
    EXPECT_TRUE(std::ranges::is_sorted(values));
    EXPECT_NEAR(values.back(), 3.67, 0.01);
}

TEST(GrainNoiseTest, WordsOfNeighboursFramesAndSeedsHaveNothingInCommon) {
    std::set<std::uint32_t> seen;
    for (const std::uint32_t frame : {0U, 1U, 4'000'000'000U}) {
        for (const std::uint32_t seed : {1U, 2U}) {
            for (std::uint32_t y = 0; y < 16; ++y) {
                for (std::uint32_t x = 0; x < 16; ++x) {
                    for (const std::uint32_t word : pcg4d({x, y, frame, seed})) seen.insert(word);
                }
            }
        }
    }
    // 6,144 of 2³² words: two alike are expected once in 230 sets.
    EXPECT_GE(seen.size(), 6143U);
}

TEST(GrainNoiseTest, TapsKeepTheVariance) {
    for (const double sigma : {0.0, 0.1, 0.2, 0.5, 1.0, 4.0}) {
        const std::vector<float> taps = grain_taps(sigma);
        double power = -std::pow(taps[0], 2);
        for (const float tap : taps) power += 2 * std::pow(tap, 2);
        EXPECT_NEAR(power, 1, 1e-6) << sigma;
        EXPECT_EQ(taps.size() == 1, sigma < least_grain_correlation_px);
    }
}

TEST(GrainNoiseTest, TheCorrelationOfNeighboursLeadsBack) {
    for (const double correlation : {0.001, 0.1, 0.3, 0.6, 0.9, 0.98}) {
        EXPECT_NEAR(grain_neighbour_correlation(grain_correlation_px(correlation)), correlation, 1e-9);
    }
    // Two Gaussians a pixel apart, where they are wide enough not to notice the pixels.
    for (const double sigma : {1.0, 2.0, 4.0}) {
        EXPECT_NEAR(grain_neighbour_correlation(sigma), std::exp(-0.25 / (sigma * sigma)), 1e-3);
    }
    for (const double none : {0.0, -0.2, -1.0, 1e-9}) EXPECT_EQ(grain_correlation_px(none), 0);
    EXPECT_LE(grain_correlation_px(1), widest_grain_correlation_px);
}

TEST(GrainNoiseTest, TheLeastDeviationIsWhereTheLargestNoiseMoves) {
    EXPECT_NEAR(least_grain_deviation({}, 0.367), 0.1, 1e-3);
    // Smoothed noise may add up values of one sign.
    EXPECT_LT(least_grain_deviation({.correlation_px = 1}, 0.367), 0.1);
    EXPECT_DOUBLE_EQ((GrainModel{.read = 0.3, .shot = 0.08, .strength = 2, .brightest = 2}.largest_deviation()), 1);
}

}  // namespace
}  // namespace matchlight
