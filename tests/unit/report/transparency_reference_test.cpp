// Transparent layers: exact sums, and what methods without an order make of them.
#include "report/transparency_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Eigen::Vector3d;

constexpr double rounding = 1e-15;

double weight_of(const TransparentLayer& layer) {
    return blended_weight(layer.depth_m, layer.opacity);
}

TEST(Transparency, OneLayerIsExactByEveryMethod) {
    const Vector3d behind(0.2, 3, 0);
    for (const double opacity : {0.0, 1e-4, 0.3, 1.0}) {
        const std::array layers{TransparentLayer{{0.9, 0.1, 5}, opacity, 2}};
        const Vector3d exact = opacity * layers[0].light + (1 - opacity) * behind;
        EXPECT_LT((composite_in_order(layers, behind) - exact).norm(), rounding);
        EXPECT_LT((weighted_sum(layers, behind) - exact).norm(), rounding);
        EXPECT_LT((weighted_blended(layers, behind, weight_of) - exact).norm(), 10 * rounding);
    }
}

TEST(Transparency, InOrderTheNearerCoversTheFarther) {
    const std::array layers{TransparentLayer{{1, 0, 0}, 0.5, 1}, TransparentLayer{{0, 1, 0}, 0.5, 2}};
    EXPECT_LT((composite_in_order(layers, {0, 0, 1}) - Vector3d(0.5, 0.25, 0.25)).norm(), rounding);
    const std::array hidden{TransparentLayer{{1, 0, 0}, 1, 1}, TransparentLayer{{0, 1, 0}, 0.5, 2}};
    EXPECT_LT((composite_in_order(hidden, {0, 0, 1}) - Vector3d(1, 0, 0)).norm(), rounding);
}

TEST(Transparency, PeelingStopsWhereItIsTold) {
    const std::vector<TransparentLayer> layers(10, TransparentLayer{{1, 1, 1}, 0.25, 1});
    for (const std::size_t count : {0U, 1U, 4U, 10U, 20U}) {
        const PeeledLight some = peeled(layers, count);
        const double left = std::pow(0.75, static_cast<double>(std::min<std::size_t>(count, 10)));
        EXPECT_NEAR(some.transmittance, left, rounding);
        EXPECT_NEAR(some.light.x(), 1 - left, rounding);
    }
}

TEST(Transparency, WeightedSumIsExactToFirstOrderInOpacity) {
    // Its error over three layers is of second order: a tenth of the opacity, a hundredth of the error.
    const auto error = [](double opacity) {
        const std::array layers{TransparentLayer{{1, 0, 0}, opacity, 1}, TransparentLayer{{0, 1, 0}, opacity, 2},
                                TransparentLayer{{0, 0, 1}, opacity, 3}};
        const Vector3d behind(0.5, 0.5, 0.5);
        return (weighted_sum(layers, behind) - composite_in_order(layers, behind)).norm();
    };
    EXPECT_NEAR(error(1e-3) / error(1e-2), 1e-2, 1e-3);
    EXPECT_GT(error(0.9), 0.5);
}

TEST(Transparency, WeightedBlendedIsExactForOneColorAndIndifferentToOrder) {
    const std::vector<TransparentLayer> grey{{{0.4, 0.4, 0.4}, 0.3, 1}, {{0.4, 0.4, 0.4}, 0.7, 2}};
    const Vector3d behind(1, 0, 0);
    EXPECT_LT((weighted_blended(grey, behind, weight_of) - composite_in_order(grey, behind)).norm(), rounding);
    const std::vector<TransparentLayer> colored{{{1, 0, 0}, 0.3, 1}, {{0, 1, 0}, 0.7, 2}};
    const std::vector<TransparentLayer> turned{colored[1], colored[0]};
    EXPECT_LT((weighted_blended(colored, behind, weight_of) - weighted_blended(turned, behind, weight_of)).norm(),
              rounding);
    EXPECT_LT((weighted_sum(colored, behind) - weighted_sum(turned, behind)).norm(), rounding);
}

TEST(Transparency, NearerLayersWeighMore) {
    EXPECT_GT(blended_weight(1, 0.5), blended_weight(40, 0.5));
    EXPECT_GT(blended_weight(40, 0.5), blended_weight(400, 0.5));
    // Depths of 0 and beyond all range keep to the paper's clamp.
    EXPECT_NEAR(blended_weight(0, 1), 3e3, 1e-9);
    EXPECT_EQ(blended_weight(1e9, 1), 1e-2);
}

}  // namespace
}  // namespace matchlight
