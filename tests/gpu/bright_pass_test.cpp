// The bright pass against its double-precision reference, at every scale and with every kind of light.
#include "render/effects/bright_pass.h"

#include <cmath>
#include <limits>
#include <random>

#include "effect_frame.h"
#include "gl_fixture.h"

namespace matchlight::test {
namespace {

class BrightPassTest : public GlTest {
protected:
    EffectResult run(const LightOnCpu& light, const BrightPassSettings& settings, int scale) {
        return run_effect(light, [&](RenderGraph& graph, const FrameLight& frame, GpuCondition& bright) {
            return add_bright_pass(graph, shaders_, frame, settings, scale, bright);
        });
    }

    ShaderLibrary shaders_;
};

/// Colours from 0.01 to 3,000 with any coverage, before and after.
LightOnCpu mixed_light(int width, int height) {
    LightOnCpu light(width, height);
    light.before = ImageF(width, height, 3);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> share(0, 1);
    for (float& value : light.before.samples()) value = 0.01F * std::pow(3e5F, std::pow(share(random), 3.F));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) light.after.at(x, y, c) = 0.01F * std::pow(3e5F, std::pow(share(random), 3.F));
            light.after.at(x, y, 3) = share(random);
        }
    }
    return light;
}

/// Mean over texels of `scale`, dark beyond the frame.
ImageD reduced(const ImageD& full, int scale) {
    ImageD small((full.width() + scale - 1) / scale, (full.height() + scale - 1) / scale, 3);
    for (int y = 0; y < full.height(); ++y) {
        for (int x = 0; x < full.width(); ++x) {
            for (int c = 0; c < 3; ++c) small.at(x / scale, y / scale, c) += full.at(x, y, c) / (scale * scale);
        }
    }
    return small;
}

TEST_F(BrightPassTest, AgreesWithTheReferenceAtEveryScaleAndShare) {
    const LightOnCpu light = mixed_light(45, 31);
    for (const BrightShare share : {BrightShare::all, BrightShare::objects, BrightShare::rest}) {
        for (const BrightMeasure measure : {BrightMeasure::largest_channel, BrightMeasure::luminance}) {
            for (const bool firefly_safe : {false, true}) {
                for (const int scale : {1, 2, 4, 8}) {
                    const BrightPassSettings settings{.threshold = 1.2,
                                                      .knee = 0.5,
                                                      .firefly_safe = firefly_safe,
                                                      .share = share,
                                                      .object_strength = 1.5,
                                                      .measure = measure};
                    const EffectResult result = run(light, settings, scale);
                    const ImageD expected = reduced(reference_bright_light(light.after, light.before, settings), scale);
                    ASSERT_EQ(result.light.bounds(), expected.bounds());
                    double worst = 0;
                    for (std::size_t i = 0; i < expected.samples().size(); ++i) {
                        // Float sums of up to 64 terms of either sign, then half precision (2^-11).
                        const double error = std::abs(result.light.samples()[i] - expected.samples()[i]);
                        worst = std::max(worst, error / (0.01 + std::abs(expected.samples()[i])));
                    }
                    EXPECT_LT(worst, 1e-3) << "scale " << scale << ", share " << static_cast<int>(share);
                    EXPECT_TRUE(result.met);
                }
            }
        }
    }
}

TEST_F(BrightPassTest, ObjectsAndTheRestMakeUpAll) {
    const LightOnCpu light = mixed_light(16, 16);
    BrightPassSettings settings{.object_strength = 2};
    const EffectResult all = run(light, settings, 4);
    settings.share = BrightShare::objects;
    const EffectResult objects = run(light, settings, 4);
    settings.share = BrightShare::rest;
    const EffectResult rest = run(light, settings, 4);
    for (std::size_t i = 0; i < all.light.samples().size(); ++i) {
        const double sum = objects.light.samples()[i] + rest.light.samples()[i];
        const double size = std::abs(objects.light.samples()[i]) + std::abs(rest.light.samples()[i]);
        EXPECT_NEAR(all.light.samples()[i], sum, 2e-3 * size + 1e-6);
    }
}

TEST_F(BrightPassTest, TheCurveIsContinuousAndMonotone) {
    for (const double knee : {0.0, 0.2, 1.0}) {
        double last = 0;
        for (int i = 0; i <= 40000; ++i) {
            const double m = i * 1e-4;
            const double out = m * bright_share(m, 1.5, knee);
            EXPECT_GE(out, last);
            EXPECT_LE(out - last, 1.0001e-4);  // never steeper than 1
            last = out;
        }
        EXPECT_NEAR(last, 4 - 1.5, 1e-12);
    }
    EXPECT_EQ(bright_share(0, 0, 0.5), 0);
    EXPECT_EQ(bright_share(3, 0, 0.5), 1);  // without a threshold all light spills
}

TEST_F(BrightPassTest, WithoutBrightLightTheConditionIsUnmet) {
    LightOnCpu light(13, 9);
    light.before = ImageF(13, 9, 3, 0.4F);
    for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < 13; ++x) light.set(x, y, 0.49F, 0.5F);
    }
    EXPECT_FALSE(run(light, {.threshold = 1, .knee = 0.5}, 4).met);
    light.set(12, 8, 0.51F);
    EXPECT_TRUE(run(light, {.threshold = 1, .knee = 0.5}, 4).met);
    // Bright as it may be: what objects leave as it was spills already.
    std::fill(light.before.samples().begin(), light.before.samples().end(), 30.F);
    for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < 13; ++x) light.set(x, y, 30, 0);
    }
    EXPECT_FALSE(run(light, {}, 4).met);
}

TEST_F(BrightPassTest, HiddenLightIsTakenAway) {
    LightOnCpu light(8, 8);
    light.before = ImageF(8, 8, 3);
    for (int c = 0; c < 3; ++c) light.before.at(5, 2, c) = 21;
    const EffectResult result = run(light, {.threshold = 1, .knee = 0}, 4);
    EXPECT_NEAR(result.light.at(1, 0, 0), -20.0 / 16, 1e-3);
    EXPECT_EQ(result.light.at(0, 0, 0), 0);
}

TEST_F(BrightPassTest, ExtremesStayFinite) {
    const float infinity = std::numeric_limits<float>::infinity();
    const float not_a_number = std::numeric_limits<float>::quiet_NaN();
    for (const int scale : {1, 4}) {
        for (const bool firefly_safe : {false, true}) {
            const auto one_pixel = [&](float value, float coverage) {
                LightOnCpu light(9, 7);
                light.set(3, 5, value, coverage);
                return run(light, {.firefly_safe = firefly_safe}, scale);
            };
            for (const float dark : {0.F, 1e-8F, -1e9F, -infinity, not_a_number}) {
                const EffectResult result = one_pixel(dark, 1);
                EXPECT_FALSE(result.met) << dark;
                EXPECT_EQ(result.sum(), 0) << dark;
            }
            for (const float bright : {65504.F, 1e9F, infinity}) {
                const EffectResult result = one_pixel(bright, 1);
                EXPECT_TRUE(result.met);
                for (const double value : result.light.samples()) EXPECT_TRUE(value >= 0 && value <= 65504);
                // A block of 16 weighs its sun 1/66.5: 65503·16/66.5/(15 + 1/66.5) plate-linear pixels are left.
                EXPECT_NEAR(result.sum(), firefly_safe ? 1049.5 : 65503, firefly_safe ? 2 : 40) << bright;
            }
            EXPECT_EQ(one_pixel(20, not_a_number).sum(), one_pixel(20, 0).sum());
        }
    }
}

TEST_F(BrightPassTest, FirefliesLoseWhatTheReferenceSays) {
    LightOnCpu light(16, 16);
    light.set(5, 5, 4000);
    for (int y = 8; y < 16; ++y) {
        for (int x = 8; x < 16; ++x) light.set(x, y, 4000);
    }
    BrightPassSettings settings{.threshold = 1, .knee = 0};
    const double all = run(light, settings, 4).sum();
    settings.firefly_safe = true;
    const double kept = run(light, settings, 4).sum();
    EXPECT_NEAR((all - kept) * 3, energy_held_back(light.after, light.before, settings), 1e-3 * all);
    EXPECT_NEAR(all - kept, 3999 - 3999.0 * 16 / 4.999 / (15 + 1 / 4.999), 1e-3 * all);  // the lone pixel's alone
}

}  // namespace
}  // namespace matchlight::test
