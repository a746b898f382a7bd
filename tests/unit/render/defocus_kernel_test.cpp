// Out-of-focus discs on texels: their variance, their sum, their shape.
#include "render/effects/defocus_kernel.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr BokehSettings round_opening{};
constexpr BokehSettings triangle{.blades = 3, .rotation_deg = 20};

double share_of(const DiscTap& tap, double radius) {
    return std::clamp(radius + 0.5 - tap.distance, 0.0, 1.0);
}

TEST(DefocusKernel, OpeningsHaveTheirVariance) {
    EXPECT_NEAR(bokeh_variance(round_opening), 0.25, 1e-6);
    // Of a regular polygon with its corners on the unit circle: (2 + cos(2π/n)) / 12 along an axis.
    EXPECT_NEAR(bokeh_variance(triangle), 1.5 / 12, 1e-5);
    EXPECT_NEAR(bokeh_variance({.blades = 4}), 2.0 / 12, 1e-5);
}

TEST(DefocusKernel, DrawnDiscsHaveTheVarianceAskedFor) {
    const std::vector<DiscTap> taps = disc_taps(round_opening, 12, false);
    for (const double radius : {0.125, 0.4, 1.0, 2.7, 5.0, 9.3}) {
        const DrawnDisc disc = drawn_disc(taps, radius * radius / 4);
        double sum = 0, moment = 0;
        for (const DiscTap& tap : taps) {
            sum += share_of(tap, disc.radius);
            moment += share_of(tap, disc.radius) * tap.offset.squaredNorm() / 2.0;
        }
        EXPECT_NEAR(sum, disc.texels, 1e-12) << radius;
        EXPECT_NEAR(moment / sum, radius * radius / 4, 1e-9) << radius;
        if (radius > 2) {
            EXPECT_NEAR(disc.radius, radius, 0.15) << radius;
        }
    }
}

TEST(DefocusKernel, ADiscOfNoWidthIsItsOwnTexel) {
    const DrawnDisc disc = drawn_disc(disc_taps(round_opening, 2, false), 0);
    EXPECT_EQ(disc.radius, 0);
    EXPECT_EQ(disc.texels, 0.5);  // its middle alone, which the drawing divides by
}

TEST(DefocusKernel, BeforeTheFocusTheOpeningIsTurnedRound) {
    const std::vector<DiscTap> beyond = disc_taps(triangle, 4, false), before = disc_taps(triangle, 4, true);
    ASSERT_EQ(beyond.size(), before.size());
    int different = 0;
    for (const DiscTap& tap : beyond) {
        const auto opposite =
            std::ranges::find_if(before, [&](const DiscTap& other) { return other.offset == -tap.offset; });
        ASSERT_NE(opposite, before.end());
        EXPECT_DOUBLE_EQ(opposite->distance, tap.distance);
        const auto same =
            std::ranges::find_if(before, [&](const DiscTap& other) { return other.offset == tap.offset; });
        different += same == before.end() || std::abs(same->distance - tap.distance) > 0.1 ? 1 : 0;
    }
    EXPECT_GT(different, 10);
}

TEST(DefocusKernel, TheTableHoldsWhatIsDrawn) {
    const ImageF table = disc_table(round_opening, 8, 0.25, 2);
    const std::vector<DiscTap> taps = disc_taps(round_opening, 12, false);
    for (const int entry : {2, 9, 30}) {
        const double radius = 0.25 * entry;
        const DrawnDisc plain = drawn_disc(taps, radius * radius / 4);
        EXPECT_NEAR(table.at(entry, 0, 0), plain.radius, 1e-5);
        EXPECT_NEAR(table.at(entry, 0, 1), plain.texels, 1e-5 * plain.texels);
        // Resampling to texels of two and back blurs besides: the disc is drawn the smaller.
        EXPECT_LT(table.at(entry, 1, 0), table.at(entry, 0, 0));
    }
}

}  // namespace
}  // namespace matchlight
