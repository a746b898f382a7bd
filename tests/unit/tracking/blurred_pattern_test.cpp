// The closed form of a blurred tag against sums over a fine grid and finite differences.
#include "tracking/blurred_pattern.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

/// Paper seen by the footprint, by brute force: midpoint rule over ±5 standard deviations and the pixel's box.
double summed(const TagPattern& pattern, double a, double b, const AxisFootprint& along_a,
              const AxisFootprint& along_b) {
    constexpr int steps = 100;
    double sum = 0, weights = 0;
    for (int v = 0; v < steps; ++v) {
        for (int u = 0; u < steps; ++u) {
            const double gauss_a = (u + 0.5) / steps * 10 - 5, gauss_b = (v + 0.5) / steps * 10 - 5;
            const double weight = std::exp(-0.5 * (gauss_a * gauss_a + gauss_b * gauss_b));
            constexpr int box_steps = 8;
            for (int j = 0; j < box_steps; ++j) {
                for (int i = 0; i < box_steps; ++i) {
                    const double x = a + gauss_a * along_a.blur + ((i + 0.5) / box_steps - 0.5) * along_a.pixel_width;
                    const double y = b + gauss_b * along_b.blur + ((j + 0.5) / box_steps - 0.5) * along_b.pixel_width;
                    const int cell_x = std::clamp(static_cast<int>(std::floor(x)), 0, pattern.cells - 1);
                    const int cell_y = std::clamp(static_cast<int>(std::floor(y)), 0, pattern.cells - 1);
                    sum += weight * (pattern.at(cell_x, cell_y) == TagPattern::white);
                    weights += weight;
                }
            }
        }
    }
    return sum / weights;
}

TEST(BlurredPattern, EqualsTheConvolution) {
    const TagPattern tag = TagFamily("tag36h11").pattern(7);
    const BlurredPattern pattern(tag);
    for (const double blur : {0.1, 0.4, 1.2}) {
        for (const auto& [a, b] : {std::pair{3.2, 4.9}, {1.05, 6.5}, {5.5, 5.45}, {8.9, 1.1}}) {
            const AxisFootprint along_a{0.2, blur}, along_b{0.3, 0.7 * blur};
            // The midpoint rule's own error is about half a step of the finest axis.
            EXPECT_NEAR(pattern.at(a, b, along_a, along_b, 0).paper, summed(tag, a, b, along_a, along_b), 4e-3)
                << a << " " << b << " blur " << blur;
        }
    }
}

TEST(BlurredPattern, DerivativesAreThoseOfItsValue) {
    const BlurredPattern pattern(TagFamily("tagStandard41h12").pattern(11));
    const double a = 3.9, b = 2.2, h = 1e-5;
    const AxisFootprint along_a{0.15, 0.3}, along_b{0.2, 0.25};
    const PatternSample sample = pattern.at(a, b, along_a, along_b, 0);
    const auto value = [&](double da, double db, double blur_a, double blur_b) {
        return pattern.at(a + da, b + db, {0.15, 0.3 + blur_a}, {0.2, 0.25 + blur_b}, 0).paper;
    };
    EXPECT_NEAR(sample.by_a, (value(h, 0, 0, 0) - value(-h, 0, 0, 0)) / (2 * h), 1e-4);
    EXPECT_NEAR(sample.by_b, (value(0, h, 0, 0) - value(0, -h, 0, 0)) / (2 * h), 1e-4);
    EXPECT_NEAR(sample.by_blur_a, (value(0, 0, h, 0) - value(0, 0, -h, 0)) / (2 * h), 1e-4);
    EXPECT_NEAR(sample.by_blur_b, (value(0, 0, 0, h) - value(0, 0, 0, -h)) / (2 * h), 1e-4);
    EXPECT_GT(std::abs(sample.by_a) + std::abs(sample.by_b), 0.1);  // the point lies on edges
}

TEST(BlurredPattern, KnowsWhereItCannotTell) {
    const BlurredPattern round(TagFamily("tagCircle21h7").pattern(0));
    EXPECT_FALSE(round.is_known(0.5, 0.5));   // a corner without ink of its own
    EXPECT_FALSE(round.is_known(0.25, 4.5));  // paper or table may begin at the edge of the grid
    EXPECT_TRUE(round.is_known(4.5, 4.5));
    EXPECT_TRUE(round.is_known(1.6, 2.6));
    EXPECT_FALSE(round.is_known(-1, 4));
    const BlurredPattern square(TagFamily("tag36h11").pattern(0));
    EXPECT_TRUE(square.is_known(0.75, 5));
    EXPECT_FALSE(square.is_known(0.25, 5));
    EXPECT_NEAR(square.distance_to_edge(1.2, 5), 0.2, 1e-12);
}

}  // namespace
}  // namespace matchlight
