// Composition: one pass or two, the code values are the same; spilled light is added in linear light.
#include <algorithm>

#include <gtest/gtest.h>

#include "composite_noise.h"
#include "gl_fixture.h"

namespace matchlight {
namespace {

using test::composite_noise;

class CompositeTest : public GlTest {
protected:
    void SetUp() override {
        for (ShadowMap* map : {&shadow_.fine, &shadow_.far}) {
            map->loss = Texture2D({.format = GL_RGBA32F, .width = 16, .height = 16});
            map->loss.clear(0, 0, 0, 0);
            map->rectangle_m = {Eigen::Vector2d(-0.2, -1), Eigen::Vector2d(0.2, 1)};
        }
        shadow_.fine.loss.clear(0.25F, 0.5F, 0.125F, 0);
    }

    ShaderLibrary shaders_;
    ContactShadow shadow_;  // over the middle of the picture
};

TEST_F(CompositeTest, WithoutSpilledLightTheLightPassesChangeNoBit) {
    const ImageF at_once = composite_noise(shaders_, {.shadow = &shadow_});
    const ImageF through_light = composite_noise(shaders_, {.shadow = &shadow_, .through_light = true});
    EXPECT_TRUE(std::ranges::equal(at_once.samples(), through_light.samples()));
    const ImageF with_nothing = composite_noise(shaders_, {.shadow = &shadow_, .through_light = true, .spill = 0.0F});
    EXPECT_TRUE(std::ranges::equal(at_once.samples(), with_nothing.samples()));
}

TEST_F(CompositeTest, SpilledLightIsAddedInLinearLight) {
    const ImageF plate = composite_noise(shaders_, {});
    const ImageF lit = composite_noise(shaders_, {.through_light = true, .spill = 0.125F});
    const ImageF dimmed = composite_noise(shaders_, {.through_light = true, .spill = -0.125F});
    for (int x = 0; x < 64; x += 7) {
        const double light = std::pow(plate.at(x, 30, 1), 2.2);
        EXPECT_NEAR(std::pow(lit.at(x, 30, 1), 2.2), std::min(light + 0.125, 1.0), 1e-3) << x;
        EXPECT_NEAR(std::pow(dimmed.at(x, 30, 1), 2.2), std::max(light - 0.125, 0.0), 1e-3) << x;
    }
}

TEST_F(CompositeTest, LightThatMovesNoCodeLeavesThePlatesOwn) {
    const ImageF plate = composite_noise(shaders_, {});
    const ImageF lit = composite_noise(shaders_, {.through_light = true, .spill = 0.001F});
    int kept = 0, changed = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            if (lit.at(x, y, 3) > 0) {
                ++changed;
                continue;
            }
            ++kept;
            for (int c = 0; c < 3; ++c) EXPECT_EQ(lit.at(x, y, c), plate.at(x, y, c));
        }
    }
    // In the dark a thousandth of light is a code and more, in the bright it is less than a half.
    EXPECT_GT(kept, 100);
    EXPECT_GT(changed, 100);
}

}  // namespace
}  // namespace matchlight
