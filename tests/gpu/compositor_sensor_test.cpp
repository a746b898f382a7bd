// What sensor, lens and codec do to the virtual part of whole frames: grain, vignette, colour fringes, softness.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "compositor_shot.h"

namespace matchlight {
namespace {

using test::CompositorTest, test::make_shot, test::Shot;

/// Noise of one sample over the standard deviation that the model says is missing there.
struct GrainSample {
    double light = 0, normalised = 0;
};
struct GrainSeen {
    std::vector<GrainSample> objects, shadows;
    int untouched_changed = 0;
};

GrainSeen seen_grain(const FrameLayers& plain, const FrameLayers& grainy, const ImageF& plate,
                     const GrainSettings& settings) {
    GrainSeen seen;
    const auto variance = [&](double light) {
        return *settings.read * *settings.read + *settings.shot * std::min(light, 1.0);
    };
    const Region both = plain.region.intersected(grainy.region);
    for (int y = both.y; y < both.y + both.height; ++y) {
        for (int x = both.x; x < both.x + both.width; ++x) {
            const int px = x - plain.region.x, py = y - plain.region.y;
            const double alpha = plain.alpha.at(px, py);
            for (int c = 0; c < 3; ++c) {
                const double light = plain.beauty.at(px, py, c), ratio = plain.shadow.at(px, py, c);
                const double noise = grainy.beauty.at(x - grainy.region.x, y - grainy.region.y, c) - light;
                const double kept = ratio * (1 - alpha);
                if (kept == 1) {
                    seen.untouched_changed += noise != 0;
                    continue;
                }
                const double missing = variance(light) - kept * kept * variance(plate.at(x, y, c));
                // Four deviations below, so that noise never meets black; and none so small that it counts as none.
                if (light < 4 * std::sqrt(variance(light)) || missing < 1e-7) continue;
                const GrainSample sample{light, noise / std::sqrt(missing)};
                if (alpha > 0.999) seen.objects.push_back(sample);
                if (alpha == 0) seen.shadows.push_back(sample);
            }
        }
    }
    return seen;
}

/// The variance is 1, to four standard errors.
void expect_unit_variance(std::span<const GrainSample> samples, const char* what) {
    double sum = 0;
    for (const GrainSample& sample : samples) sum += sample.normalised * sample.normalised;
    const double count = static_cast<double>(samples.size());
    EXPECT_NEAR(sum / count, 1, 4 * std::sqrt(2 / count)) << what << ", " << count;
}

TEST_F(CompositorTest, GrainFillsUpToTheModelsVariance) {
    Shot shot = make_shot();
    shot.scene.objects[0].scale.setConstant(0.12);
    shot.scene.objects[0].material.metallic = 0;
    shot.scene.objects[0].material.roughness = 1;
    Warnings warnings;
    warnings.set_quiet(true);
    const auto layers_of = [&](ImageF& plate_linear) {
        const PlateFrame plate = test::grey_plate(320, 180, plate_luma_);
        Compositor compositor(context(), shot.scene, shot.solve, {.quality = QualityLevel::draft, .layers = true},
                              warnings);
        plate_linear = compositor.plate_linear(plate);
        return *compositor.composite(plate).layers;
    };
    ImageF plate;
    const FrameLayers plain = layers_of(plate);
    shot.scene.effects.grain = GrainSettings{.read = 0.003, .shot = 2e-4, .correlation_px = 0.0};
    GrainSeen seen = seen_grain(plain, layers_of(plate), plate, *shot.scene.effects.grain);
    EXPECT_EQ(seen.untouched_changed, 0);
    ASSERT_GT(seen.objects.size(), 5'000U);
    ASSERT_GT(seen.shadows.size(), 2'000U);
    std::ranges::sort(seen.objects, {}, &GrainSample::light);
    const std::span<const GrainSample> objects = seen.objects;
    const std::size_t half = objects.size() / 2;
    expect_unit_variance(objects.first(half), "the darker half of the object");
    expect_unit_variance(objects.subspan(half), "the brighter half");
    expect_unit_variance(seen.shadows, "shadow");
    EXPECT_GT(objects[half + half / 2].light, 1.25 * objects[half / 2].light) << "more than one level of light";
}

TEST_F(CompositorTest, GrainIsTheSameOnceAgainAndInEveryWayOfDrawing) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.grain = GrainSettings{.read = 0.01, .shot = 1e-3, .correlation_px = 0.6};
    const CompositedFrame grainy = composite(shot, true);
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), grainy.rgb16().samples()));
    EXPECT_EQ(std::ranges::count(plain.touched.samples(), 255), std::ranges::count(grainy.touched.samples(), 255));
    EXPECT_TRUE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, true).rgb16().samples()));
    EXPECT_TRUE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, false).rgb16().samples()));
    // With effects of bright light, of which there is none, the noise comes in another pass.
    shot.scene.effects.bloom = BloomSettings{.threshold = 1e5};
    EXPECT_TRUE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, true).rgb16().samples()));
    shot.scene.effects.bloom.reset();
    shot.scene.effects.grain->seed = 2;
    EXPECT_FALSE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

TEST_F(CompositorTest, GrainThatNobodySees) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    for (const GrainSettings& none :
         {GrainSettings{.read = 0, .shot = 0}, GrainSettings{.read = 1e-5, .shot = 1e-12, .correlation_px = 1.0},
          GrainSettings{.read = 0.1, .shot = 0.1, .strength = 0}}) {
        shot.scene.effects.grain = none;
        expect_same_without(shot, "grain/white");
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    }
    // Neither scene nor solve knows the noise.
    shot.scene.effects.grain = GrainSettings{};
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    shot.solve.noise = {0.01, 1e-3};
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

TEST_F(CompositorTest, TheVignetteIsTheSolvesUnlessSetOrOff) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.solve.vignette = {-0.9, 0.1};
    const CompositedFrame solved = composite(shot, true);
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), solved.rgb16().samples()));
    shot.scene.effects.vignette.reset();
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    shot.solve.vignette.reset();
    shot.scene.effects.vignette = VignetteSettings{.v1 = -0.9, .v2 = 0.1};
    EXPECT_TRUE(std::ranges::equal(solved.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

/// A black ball before a white plate, left of the middle.
Shot black_ball() {
    Shot shot = make_shot();
    shot.scene.surface.shadow = false;
    ObjectSettings& ball = shot.scene.objects[0];
    ball.translate_m.x() = -0.16;
    ball.scale.setConstant(0.08);
    ball.material.metallic = 0;
    ball.material.roughness = 1;
    ball.material.base_color = {0, 0, 0};
    shot.solve.frames[0].exposure_ev = -20;
    return shot;
}

TEST_F(CompositorTest, ABlackObjectBeforeAWhitePlateHasColouredFringes) {
    plate_luma_ = 235;
    Shot shot = black_ball();
    const Image8 plain = composite(shot, true).rgb8();
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 4, .blue_px = -4};
    const CompositedFrame fringed = composite(shot, true);
    EXPECT_TRUE(was_drawn("chromatic aberration"));
    EXPECT_TRUE(std::ranges::equal(fringed.rgb16().samples(), composite(shot, false).rgb16().samples()));
    const Image8 after = fringed.rgb8();
    std::array<double, 3> dark{}, moved{};
    int cyan = 0, yellow = 0;
    for (int y = 0; y < 180; ++y) {
        for (int x = 0; x < 320; ++x) {
            const auto lost = [&](int c) { return 255.0 - after.at(x, y, c); };
            for (int c = 0; c < 3; ++c) {
                dark[static_cast<std::size_t>(c)] += lost(c);
                moved[static_cast<std::size_t>(c)] += x * lost(c);
            }
            ASSERT_EQ(after.at(x, y, 1), plain.at(x, y, 1)) << "green stays";
            cyan += after.at(x, y, 0) < 60 && after.at(x, y, 2) > 200;
            yellow += after.at(x, y, 0) > 200 && after.at(x, y, 2) < 60;
        }
    }
    EXPECT_GT(cyan, 20);
    EXPECT_GT(yellow, 20);
    // Left of the middle red moves to the left, blue to the right, by 4 px · r / r of the corner: at 85 of 184 px.
    EXPECT_NEAR(moved[0] / dark[0] - moved[1] / dark[1], -1.85, 0.2);
    EXPECT_NEAR(moved[2] / dark[2] - moved[1] / dark[1], 1.85, 0.2);
}

TEST_F(CompositorTest, ChromaticAberrationUnderAQuarterPixel) {
    Shot shot = make_shot();
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 0.24, .blue_px = -0.24};
    expect_same_without(shot, "chromatic aberration");
    // More in the corners, but the ball is in the middle.
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 0.5, .blue_px = {}};
    expect_same_without(shot, "chromatic aberration");
    // Nobody says how much.
    const CompositedFrame plain = composite(make_shot(), true);
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{};
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

TEST_F(CompositorTest, SoftnessIsTheSolvesOrSetOrNone) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.softness = SoftnessSettings{};
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    for (const double sigma_px : {0.0, 0.1, 0.199}) {
        shot.scene.effects.softness->sigma_px = sigma_px;
        expect_same_without(shot, "softness/across");
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    }
    shot.scene.effects.softness->sigma_px.reset();
    shot.solve.softness_px = 0.8;
    const CompositedFrame solved = composite(shot, true);
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), solved.rgb16().samples()));
    EXPECT_TRUE(std::ranges::equal(solved.rgb16().samples(), composite(shot, false).rgb16().samples()));
    shot.solve.softness_px.reset();
    shot.scene.effects.softness->sigma_px = 0.8;
    EXPECT_TRUE(std::ranges::equal(solved.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

}  // namespace
}  // namespace matchlight
