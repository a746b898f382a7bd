// Streaks against their double-precision references: shape, directions, length, energy, extremes, motion.
#include "render/effects/streaks.h"

#include <cmath>
#include <limits>

#include "effect_frame.h"
#include "gl_fixture.h"
#include "lamps.h"
#include "render/effects/streak_lines.h"
#include "report/streaks_reference.h"
#include "shown.h"

namespace matchlight::test {
namespace {

class StreaksTest : public GlTest {
protected:
    EffectResult run(const LightOnCpu& light, const GlareSettings& settings, const StreakKnobs& knobs = {},
                     const StreakSource& source = {}) {
        return run_effect(light, [&](RenderGraph& graph, const FrameLight& frame, GpuCondition& bright) {
            return add_streaks(graph, shaders_, frame, settings, knobs, source, bright);
        });
    }

    ShaderLibrary shaders_;
};

ImageD reference_of(const LightOnCpu& light, const GlareSettings& settings) {
    const ImageD bright = reference_bright_light(light.after, light.before, streak_light(settings));
    return settings.level == GlareLevel::classic ? reference_classic_streaks(bright, settings)
                                                 : reference_streaks(bright, settings);
}

double sum_of(const ImageD& image) {
    double sum = 0;
    for (std::size_t i = 0; i < image.samples().size(); i += 3) sum += image.samples()[i];
    return sum;
}

TEST(StreakTaps, SumToKawasesGain) {
    for (const double a : {0.0, 0.5, 0.92, 0.95, 0.99, 0.999}) {
        for (const int passes : {1, 2, 3, 5}) {
            const StreakTaps taps = StreakTaps::of_passes(passes, a);
            const double expected = (1 - std::pow(a, std::pow(4, passes))) / (1 - a);
            EXPECT_NEAR(taps.gain / expected, 1, 1e-9) << a << ", " << passes;
            ASSERT_EQ(taps.passes.size(), static_cast<std::size_t>(passes));
            for (int p = 0; p < passes; ++p) {
                const StreakTaps::Pass& pass = taps.passes[static_cast<std::size_t>(p)];
                EXPECT_EQ(pass.stride, static_cast<int>(std::pow(4, p)));
                double sum = 0;
                for (int s = 0; s < 4; ++s) {
                    sum += pass.weights[static_cast<std::size_t>(s)];
                    EXPECT_NEAR(pass.weights[static_cast<std::size_t>(s)] / pass.weights[0],
                                std::pow(a, pass.stride * s), 1e-6);
                }
                EXPECT_NEAR(sum, 1, 1e-6);
            }
        }
    }
    // Any length: as many taps as texels, the last one in part.
    EXPECT_NEAR(StreakTaps::of_length(64, 0.92, 16).gain, (1 - std::pow(0.92, 64)) / 0.08, 1e-9);
    EXPECT_NEAR(StreakTaps::of_length(37.5, 0.999999, 16).gain, 37.5, 1e-2);
    EXPECT_NEAR(StreakTaps::of_length(0.3, 0.9, 16).gain, 0.3, 1e-12);
}

TEST(StreakLines, ShareOppositeDirections) {
    const auto lines_of = [](int directions, double angle_deg) {
        return streak_lines(streak_angles({.directions = directions, .angle_deg = angle_deg}));
    };
    const std::vector<StreakLine> diagonals = lines_of(4, 45);
    ASSERT_EQ(diagonals.size(), 2u);
    for (const StreakLine& line : diagonals) {
        EXPECT_TRUE(line.forward && line.backward && line.is_whole());
    }
    EXPECT_EQ(lines_of(6, 10).size(), 3u);
    const std::vector<StreakLine> three = lines_of(3, 90);
    ASSERT_EQ(three.size(), 3u);
    EXPECT_TRUE(three[0].is_steep && three[0].backward && !three[0].forward);  // up: towards smaller rows
    for (const int directions : {1, 2, 5, 8, 13, 64}) {
        int total = 0;
        for (const StreakLine& line : lines_of(directions, 17)) {
            EXPECT_LE(std::abs(line.slope), 1);
            total += line.directions();
        }
        EXPECT_EQ(total, directions);
    }
}

TEST_F(StreaksTest, AgreeWithTheReferenceInAllDirections) {
    for (const auto& [width, height] : {std::pair{7, 5}, {33, 64}, {641, 361}}) {
        const LightOnCpu light = lamps(width, height);
        for (const auto& [directions, angle] : {std::pair{4, 45.0}, {2, 0.0}, {3, 90.0}, {6, 20.0}, {1, -110.0}}) {
            const GlareSettings settings{.directions = directions, .angle_deg = angle};
            const ImageD expected = reference_of(light, settings);
            const ShownError error = shown_error(light, expected, run(light, settings).at_full_size(light.frame));
            // Below 128 lines light fades over less than a pixel, and single pixels can but say how much of it there
            // is.
            const double fades_within = height < streak_steps_of_frame ? 3 : 1;
            EXPECT_LT(error.flip, 0.0066 * fades_within) << width << ", " << directions << " from " << angle;
            EXPECT_LT(error.relative_rms, 0.04 * fades_within) << width << ", " << directions << " from " << angle;
        }
    }
}

TEST_F(StreaksTest, EachQualityIsNearerToTheReferenceThanTheOneBelow) {
    for (const auto& [width, height] : {std::pair{640, 360}, {720, 540}}) {
        const LightOnCpu light = lamps(width, height);
        for (const double angle : {45.0, 20.0}) {
            const GlareSettings settings{.angle_deg = angle};
            const ImageD expected = reference_of(light, settings);
            double last = 1;
            for (const QualityLevel quality :
                 {QualityLevel::draft, QualityLevel::preview, QualityLevel::final_, QualityLevel::reference}) {
                const EffectResult result = run(light, settings, streak_knobs(quality));
                const double error = shown_error(light, expected, result.at_full_size(light.frame)).relative_rms;
                EXPECT_LT(error, 0.8 * last) << width << ", quality " << static_cast<int>(quality);
                last = error;
            }
            EXPECT_LT(last, 5e-3);
        }
    }
}

TEST_F(StreaksTest, TheReferenceHasConverged) {
    const LightOnCpu light = small_sun(60, 40, 50, 160, 90);
    const GlareSettings settings;
    const ImageD bright = reference_bright_light(light.after, light.before, streak_light(settings));
    const ImageD once = reference_streaks(bright, settings), twice = reference_streaks(bright, settings, 12);
    EXPECT_LT(shown_error(light, twice, once).relative_rms, 1e-7);
}

TEST_F(StreaksTest, ClassicAgreesWithItsConvergedForm) {
    for (const auto& [width, height] : {std::pair{7, 5}, {641, 361}, {1280, 720}}) {
        const LightOnCpu light = lamps(width, height);
        for (const double attenuation : {0.85, 0.95}) {
            const GlareSettings settings{.level = GlareLevel::classic, .attenuation = attenuation};
            const ImageD expected = reference_of(light, settings);
            const ShownError error = shown_error(light, expected, run(light, settings).at_full_size(light.frame));
            EXPECT_LT(error.relative_rms, 0.03)
                << width;  // interpolated twice: to texels of up to 4 pixels, and to pixels
            EXPECT_LT(error.flip, 0.003) << width;
        }
    }
}

TEST_F(StreaksTest, RunWhereTheAnglePoints) {
    LightOnCpu light(201, 201);
    light.set(100, 100, 100);
    for (const auto& [angle, right, down] : {std::tuple{0.0, 1, 0}, {90.0, 0, -1}, {180.0, -1, 0}, {225.0, -1, 1}}) {
        const EffectResult result = run(light, {.directions = 1, .angle_deg = angle});
        const ImageD full = result.at_full_size(light.frame);
        EXPECT_GT(full.at(100 + 20 * right, 100 + 20 * down), 0.01) << angle;
        EXPECT_LT(full.at(100 - 20 * right, 100 - 20 * down), 1e-6) << angle;
        EXPECT_LT(full.at(100 + 20 * down, 100 + 20 * right), right * down != 0 ? 1 : 1e-6) << angle;
    }
}

TEST_F(StreaksTest, WhatComesInGoesOutWhateverTheDirections) {
    LightOnCpu light(640, 640);
    for (int y = 310; y < 330; ++y) {
        for (int x = 310; x < 330; ++x) light.set(x, y, 30);
    }
    for (const int directions : {1, 2, 3, 4, 6, 8, 64}) {
        for (const double attenuation : {0.0, 0.5, 0.92, 0.999}) {
            const GlareSettings settings{
                .directions = directions, .angle_deg = 17, .attenuation = attenuation, .passes = 2};
            const ImageD taken = reference_bright_light(light.after, light.before, streak_light(settings));
            const double kept = run(light, settings).sum() / (settings.strength * sum_of(taken));
            EXPECT_NEAR(kept, 1, 4e-3) << directions << ", " << attenuation;
        }
    }
}

TEST_F(StreaksTest, AreAlikeAtEveryResolution) {
    // Along a streak, at shares of the frame's height: the same share of a lamp's light per height².
    const auto profile = [&](int height) {
        LightOnCpu light(height, height);
        const int middle = height / 2, half = height / 36;
        for (int y = middle - half; y < middle + half; ++y) {
            for (int x = middle - half; x < middle + half; ++x) light.set(x, y, 20);
        }
        const ImageD full = run(light, {.directions = 2, .angle_deg = 0}).at_full_size(light.frame);
        std::vector<double> values;
        for (const double share : {0.05, 0.1, 0.2, 0.3, 0.4}) {
            values.push_back(full.at(middle + static_cast<int>(share * height), middle));
        }
        return values;
    };
    const std::vector<double> large = profile(1080);
    for (const int height : {180, 360, 720}) {
        const std::vector<double> small = profile(height);
        for (std::size_t i = 0; i < large.size(); ++i) EXPECT_NEAR(small[i] / large[i], 1, 0.05) << height << ", " << i;
    }
}

TEST_F(StreaksTest, DazzlingReflectionHasAGlareOfItsOwn) {
    LightOnCpu light(128, 128);
    light.before = ImageF(128, 128, 3);
    light.set(40, 64, 8, 1);                                       // on an object
    light.set(90, 64, 50, 0);                                      // not on one
    for (int c = 0; c < 3; ++c) light.before.at(64, 100, c) = 50;  // hidden
    const GlareSettings own{.directions = 2, .angle_deg = 0}, scene{.directions = 2, .angle_deg = 90};
    const ImageD objects = run(light, own, {}, {BrightShare::objects, 3}).at_full_size(light.frame);
    const ImageD rest = run(light, scene, {}, {BrightShare::rest, 3}).at_full_size(light.frame);
    EXPECT_GT(objects.at(50, 64), 0.01);
    EXPECT_EQ(objects.at(90, 54), 0);
    EXPECT_GT(rest.at(90, 54), 0.01);
    EXPECT_EQ(rest.at(50, 64), 0);
    EXPECT_LT(rest.at(64, 90), -0.01);
    const ImageD plain = run(light, own, {}, {BrightShare::objects, 1}).at_full_size(light.frame);
    EXPECT_NEAR(objects.at(50, 64) / plain.at(50, 64), 3, 0.15);
}

TEST_F(StreaksTest, ExtremeLightStaysFinite) {
    const float infinity = std::numeric_limits<float>::infinity();
    for (const GlareLevel level : {GlareLevel::streaks, GlareLevel::classic}) {
        for (const double attenuation : {0.0, 0.92, 0.999}) {
            const GlareSettings settings{.level = level, .strength = 1, .attenuation = attenuation};
            const auto of_one_pixel = [&](float value) {
                LightOnCpu light(320, 240);
                light.set(161, 119, value);
                return run(light, settings);
            };
            for (const float dark : {0.F, 1e-8F, -1e9F, std::numeric_limits<float>::quiet_NaN()}) {
                EXPECT_FALSE(of_one_pixel(dark).met) << dark;
            }
            for (const float bright : {10.F, 1e3F, 65504.F, 1e9F, infinity}) {
                const EffectResult result = of_one_pixel(bright);
                EXPECT_TRUE(result.met);
                for (const double value : result.light.samples())
                    EXPECT_TRUE(value >= -1e-3 && value <= 65504) << bright;
                EXPECT_GT(result.sum(), 1);
            }
        }
    }
}

TEST_F(StreaksTest, WithoutBrightLightNothingIsDrawn) {
    LightOnCpu light(100, 80);
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 100; ++x) light.set(x, y, 1.5F);
    }
    for (const GlareLevel level : {GlareLevel::streaks, GlareLevel::classic}) {
        const EffectResult result = run(light, {.level = level, .angle_deg = 20});
        EXPECT_FALSE(result.met);
        int left_out = 0;
        for (const PassReport& report : result.reports) {
            EXPECT_EQ(report.drawn, report.name == "bright pass") << report.name;
            if (!report.drawn) ++left_out;
        }
        EXPECT_GE(left_out, 5);
    }
    EXPECT_TRUE(run(light, {.strength = 0}).is_empty);
}

TEST_F(StreaksTest, ASmallSunDoesNotFlickerAsItMoves) {
    const GlareSettings settings{.threshold = 0, .strength = 1, .angle_deg = 20};
    double least = 1e9, most = 0;
    for (int step = 0; step < 24; ++step) {
        const LightOnCpu light = small_sun(230.3 + step * 0.37, 140.1 + step * 0.21, 10, 480, 270);
        const EffectResult result = run(light, settings);
        const ImageD full = result.at_full_size(light.frame), expected = reference_of(light, settings);
        const double peak = *std::max_element(expected.samples().begin(), expected.samples().end());
        double worst = 0;
        for (std::size_t i = 0; i < expected.samples().size(); ++i) {
            worst = std::max(worst, std::abs(full.samples()[i] - expected.samples()[i]));
        }
        // At the sun itself: its streaks are half a texel wide, and drawn as straight lines between texels.
        EXPECT_LT(worst, 0.35 * peak) << step;
        least = std::min(least, result.sum());
        most = std::max(most, result.sum());
    }
    EXPECT_LT(most / least, 1.01);
}

TEST_F(StreaksTest, ALampThatEntersDoesNotPop) {
    double last = 0, largest_step = 0, whole = 0;
    for (int step = 0; step <= 80; ++step) {
        const LightOnCpu light = entering_lamp(-10 + step * 0.25, 12);
        const EffectResult result = run(light, {});
        const double sum = result.met ? result.sum() : 0;
        largest_step = std::max(largest_step, std::abs(sum - last));
        last = sum;
        whole = std::max(whole, sum);
    }
    // Of a lamp that takes 32 steps to come in, none brings more than a tenth.
    EXPECT_LT(largest_step, 0.1 * whole);
    EXPECT_GT(whole, 10);
}

TEST_F(StreaksTest, RunOnTheLargestFrames) {
    constexpr int width = 8192, height = 4320;
    Texture2D after(TextureShape{.format = GL_RGBA16F, .width = width, .height = height});
    after.clear(0.2F, 0.2F, 0.2F, 1);
    const std::vector<float> lamp(64 * 64 * 4, 9.F);
    after.upload({4100, 2200, 64, 64}, std::span<const float>(lamp));
    RenderGraph graph;
    graph.begin_frame(width, height);
    const FrameLight light{graph.import(&after, {GL_RGBA16F, {0, 0, width, height}, 1}), {}};
    GpuCondition bright("none");
    const GraphTexture streaks =
        add_streaks(graph, shaders_, light, {.threshold = 1, .knee = 0, .strength = 1}, {}, {}, bright);
    graph.output(streaks);
    graph.run();
    EXPECT_TRUE(bright.is_met());
    const GraphShape& shape = graph.shape(streaks);
    const ImageF found = graph.texture(streaks).read<float>({0, 0, shape.region.width, shape.region.height}, 3);
    double sum = 0;
    for (const float value : found.samples()) sum += value;
    EXPECT_NEAR(sum / 3 * shape.scale * shape.scale / (8.0 * 64 * 64), 1, 0.02);
}

}  // namespace
}  // namespace matchlight::test
