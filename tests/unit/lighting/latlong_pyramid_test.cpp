// Every level of a lat-long pyramid holds all of the light.
#include "lighting/latlong_pyramid.h"

#include <random>

#include <gtest/gtest.h>

#include "lighting/latlong_grid.h"

namespace matchlight {
namespace {

double power(const ImageF& latlong, int channel) {
    const LatlongGrid grid(latlong.width(), latlong.height());
    double sum = 0;
    for (int y = 0; y < latlong.height(); ++y) {
        for (int x = 0; x < latlong.width(); ++x) sum += grid.solid_angle(y) * latlong.at(x, y, channel);
    }
    return sum;
}

TEST(LatlongPyramid, KeepsTheLightOfEverySizeAndOfOnePixelSuns) {
    std::mt19937 generator(7);
    std::exponential_distribution<float> noise;
    for (const auto& [width, height] : {std::pair(64, 32), {50, 25}, {7, 3}, {2, 1}, {1, 1}}) {
        ImageF image(width, height, 3);
        for (float& value : image.samples()) value = noise(generator);
        image.at(width / 3, height / 2, 1) = 1e6F;
        const auto levels = latlong_pyramid(image);
        EXPECT_EQ(levels.back().width(), 1);
        EXPECT_EQ(levels.back().height(), 1);
        for (std::size_t level = 1; level < levels.size(); ++level) {
            EXPECT_EQ(levels[level].width(), std::max(1, levels[level - 1].width() / 2));
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(power(levels[level], c) / power(image, c), 1, 1e-6) << width << " level " << level;
            }
        }
    }
}

}  // namespace
}  // namespace matchlight
