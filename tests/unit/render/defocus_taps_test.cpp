// Samples of depth of field: areas, and slices that leave nothing out.
#include "render/effects/defocus_taps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

#include "render/effects/bokeh.h"

namespace matchlight {
namespace {

double area_of(const std::vector<DefocusTap>& taps) {
    double area = 0;
    for (const DefocusTap& tap : taps) area += tap.area_px2;
    return area;
}

TEST(DefocusTaps, RingsHaveTheAreaOfTheDiscAndEachPixelOnce) {
    for (const double radius_px : {0.1, 0.5, 3.0, 17.3, 200.0}) {
        for (const auto& [rings, ring_samples] : {std::pair{1, 3}, {4, 8}, {12, 24}, {64, 128}}) {
            const std::vector<DefocusTap> taps = ring_taps(radius_px, {.rings = rings, .ring_samples = ring_samples});
            const double outer_px = std::max(radius_px + 0.5, 1 / std::sqrt(std::numbers::pi));
            EXPECT_NEAR(area_of(taps) / (std::numbers::pi * outer_px * outer_px), 1, 1e-5) << radius_px;
            std::set<std::pair<int, int>> places;
            for (const DefocusTap& tap : taps) {
                EXPECT_TRUE(places.emplace(tap.x, tap.y).second) << tap.x << ", " << tap.y;
                EXPECT_FLOAT_EQ(tap.away_px, std::hypot(tap.x, tap.y));
            }
            EXPECT_TRUE(places.contains({0, 0}));
        }
    }
}

TEST(DefocusTaps, TheOpeningHasItsAreaAndTurnsBeforeTheFocus) {
    const BokehSettings triangle{.blades = 3, .rotation_deg = 20};
    for (const double radius : {1.5, 4.0, 12.0}) {
        // Parts of an eighth of a texel along the rim.
        const double tolerance = 0.3 / radius;
        EXPECT_NEAR(area_of(bokeh_taps({}, radius, false)) / (std::numbers::pi * radius * radius), 1, tolerance);
        EXPECT_NEAR(area_of(bokeh_taps(triangle, radius, false)) / (bokeh_area(triangle) * radius * radius), 1,
                    tolerance);
    }
    const std::vector<DefocusTap> behind = bokeh_taps(triangle, 6, false), before = bokeh_taps(triangle, 6, true);
    ASSERT_EQ(behind.size(), before.size());
    // Both run row by row, so that one is the other's reverse.
    for (std::size_t i = 0; i < behind.size(); ++i) {
        const DefocusTap& turned = before[before.size() - 1 - i];
        EXPECT_EQ(std::pair(behind[i].x, behind[i].y), std::pair(-turned.x, -turned.y));
        EXPECT_NEAR(behind[i].area_px2, turned.area_px2, 1.0 / 64);
    }
    // A corner to the right: what is there collects from the left, beyond the focus.
    double farthest_x = 0;
    for (const DefocusTap& tap : bokeh_taps({.blades = 3}, 6, false)) {
        if (std::abs(tap.x) > std::abs(farthest_x)) farthest_x = tap.x;
    }
    EXPECT_LT(farthest_x, -4);
    EXPECT_EQ(bokeh_taps({}, 0.01, false).size(), 1U) << "less than a part of a texel is the texel";
}

TEST(DefocusTaps, SlicesHoldEveryCircleOnceAndFocusApart) {
    for (const auto& [nearest_px, farthest_px] :
         {std::pair{-20.0, 7.0}, {-3.0, -0.1}, {0.0, 40.0}, {2.0, 9.0}, {0.0, 0.0}, {-9.0, -4.0}}) {
        for (const int count : {1, 2, 9, 40}) {
            const std::vector<DefocusSlice> slices = defocus_slices(nearest_px, farthest_px, count);
            for (std::size_t i = 1; i < slices.size(); ++i) {
                EXPECT_EQ(slices[i].to_px, slices[i - 1].from_px) << "back to front, without a gap";
                EXPECT_LT(slices[i].circle_px, slices[i - 1].circle_px);
            }
            EXPECT_EQ(slices.front().to_px, INFINITY);
            EXPECT_EQ(slices.back().from_px, -INFINITY);
            int in_focus = 0;
            for (const DefocusSlice& slice : slices) {
                if (slice.from_px <= 0 && slice.to_px > 0) {
                    EXPECT_EQ(slice.circle_px, 0);
                }
                in_focus += slice.circle_px == 0 ? 1 : 0;
            }
            EXPECT_EQ(in_focus, 1);
            if (nearest_px == farthest_px) {
                EXPECT_EQ(slices.size(), 1U);
            } else {
                EXPECT_NEAR(static_cast<double>(slices.size()), count + 1, 1);
            }
        }
    }
}

TEST(DefocusTaps, LevelsOfThePyramidDoubleTheirCircles) {
    EXPECT_EQ(circle_of_level_px(0), 0);
    for (int level = 1; level < 7; ++level) {
        const double circle_px = circle_of_level_px(level);
        EXPECT_NEAR(circle_px * circle_px / 16, (2 * std::pow(4, level) - 1) / 4, 1e-9);
        EXPECT_NEAR(circle_of_level_px(level + 1) / circle_px, 2, 0.11);
        EXPECT_LE(full_circle_of_level_px(level), circle_px);
    }
}

TEST(DefocusTaps, KnobsOutOfRangeAreRefused) {
    EXPECT_NO_THROW(OnePassKnobs{}.check());
    EXPECT_THROW(OnePassKnobs{.rings = 0}.check(), std::invalid_argument);
    EXPECT_THROW(OnePassKnobs{.ring_samples = 2}.check(), std::invalid_argument);
    EXPECT_THROW(OnePassKnobs{.largest_radius_px = 0}.check(), std::invalid_argument);
}

}  // namespace
}  // namespace matchlight
