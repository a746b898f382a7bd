// Diffraction on the GPU against double-precision convolution, its energy, its extremes, and when it is left out.
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "render/effects/spill.h"
#include "report/diffraction_reference.h"
#include "report/fftw_convolution.h"
#include "wave_fixture.h"

namespace matchlight {
namespace {

GlareSettings diffraction(double strength = 0.3) {
    GlareSettings settings;
    settings.level = GlareLevel::diffraction;
    settings.strength = strength;
    settings.aperture = {.blades = 5, .rotation_deg = 17, .eyelashes = 8, .dust = 5};
    return settings;
}

/// A coarse pattern, where the test is of the convolution and not of the pattern.
constexpr DiffractionQuality coarse{.aperture_side = 256, .wavelengths = 8, .samples = 0.5};

ImageF random_signed_light(int width, int height) {
    ImageF light(width, height, 3);
    std::mt19937 engine(11);
    std::uniform_real_distribution<float> uniform(-20, 60);
    for (float& sample : light.samples()) sample = uniform(engine);
    return light;
}

class DiffractionTest : public WaveTest {
protected:
    /// The kernel that a glare of these settings and options has, without its strength.
    static Image<double> kernel_of(const GlareSettings& settings, const WaveGlareOptions& options, int scale) {
        return make_diffraction_kernel(settings.aperture, diffraction_reach_px(settings, options.frame_height),
                                       {.scale = scale}, options.knobs.diffraction);
    }
};

TEST_F(DiffractionTest, IsTheConvolutionThatFftwGives) {
    const GlareSettings settings = diffraction();
    for (const auto& [width, height] : {std::array{97, 61}, {64, 64}, {200, 31}, {5, 90}}) {
        const WaveGlareOptions options{
            .frame_width = width, .frame_height = height, .knobs = {.full_float = true, .diffraction = coarse}};
        WaveGlare glare(shaders_, settings, options);
        ASSERT_EQ(glare.scale(), 1);
        const ImageF light = rounded_to_half(random_signed_light(width, height));
        const WaveResult result = run(glare, light, width, height);
        ASSERT_EQ(result.region, (Region{0, 0, width, height}));
        Image<double> truth = convolve_fftw(to_double(light), kernel_of(settings, options, 1));
        for (double& sample : truth.samples()) sample *= settings.strength;
        // 32-bit floats: six roundings a transform of 1e-7, three transforms.
        EXPECT_LT(relative_rms(truth, to_double(result.light)), 2e-6) << width << "x" << height;
    }
}

TEST_F(DiffractionTest, RegionsGiveWhatTheWholeFrameGives) {
    constexpr int width = 160, height = 90;
    const GlareSettings settings = diffraction();
    WaveGlare glare(
        shaders_, settings,
        {.frame_width = width, .frame_height = height, .knobs = {.full_float = true, .diffraction = coarse}});
    const ImageF light = random_signed_light(30, 20);
    for (const auto& [x, y] : {std::array{0, 0}, {130, 70}, {65, 0}, {60, 35}, {3, 68}}) {
        ImageF whole(width, height, 3);
        for (int v = 0; v < 20; ++v) std::copy(light.row(v).begin(), light.row(v).end(), whole.pixel(x, y + v));
        const WaveResult of_whole = run(glare, whole, width, height);
        const WaveResult of_part = run(glare, light, width, height, x, y);
        EXPECT_EQ(of_part.region, (Region{x, y, 30, 20}.grown(glare.reach()).intersected({0, 0, width, height})));
        double error = 0, total = 0;
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                const bool inside = of_part.region.contains(u, v);
                const double part = inside ? of_part.light.at(u - of_part.region.x, v - of_part.region.y, 1) : 0.0;
                error += std::pow(part - of_whole.light.at(u, v, 1), 2);
                total += std::pow(of_whole.light.at(u, v, 1), 2);
            }
        }
        EXPECT_LT(std::sqrt(error / total), 2e-6) << x << " " << y;
    }
}

TEST_F(DiffractionTest, KeepsTheEnergyOfTheLight) {
    constexpr int width = 256, height = 256;
    for (const int least_scale : {1, 2, 4}) {
        WaveGlare glare(shaders_, diffraction(0.3),
                        {.frame_width = width,
                         .frame_height = height,
                         .knobs = {.least_scale = least_scale, .diffraction = coarse}});
        const int side = width / glare.scale();
        ImageF light(side, side, 3);
        // In the middle, so that none leaves the frame; a little of it was taken away.
        light.at(side / 2, side / 2, 0) = 900;
        light.at(side / 2 + 3, side / 2, 1) = 70;
        light.at(side / 2, side / 2 - 4, 2) = 64000;
        light.at(side / 2, side / 2 - 5, 2) = -1000;
        const WaveResult result = run(glare, light, width, height);
        // Half floats of the result lose up to 2^-10 of each texel: some drivers cut instead of rounding.
        EXPECT_NEAR(sum_of(result.light, 0), 0.3 * 900, 0.3 * 900 * 1e-3);
        EXPECT_NEAR(sum_of(result.light, 1), 0.3 * 70, 0.3 * 70 * 1e-3);
        EXPECT_NEAR(sum_of(result.light, 2), 0.3 * 63000, 0.3 * 63000 * 1e-3);
    }
}

TEST_F(DiffractionTest, NothingComesRoundFromTheOtherEdge) {
    constexpr int width = 128, height = 128;
    WaveGlare glare(shaders_, diffraction(1),
                    {.frame_width = width, .frame_height = height, .knobs = {.diffraction = coarse}});
    ASSERT_EQ(glare.reach(), 32);
    for (const auto& [x, y] : {std::array{0, 64}, {127, 64}, {64, 0}, {64, 127}, {0, 0}, {127, 127}}) {
        ImageF light(width, height, 3);
        light.at(x, y, 1) = 60000;
        const WaveResult result = run(glare, light, width, height);
        double nearby = 0;
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                const double value = std::abs(result.light.at(u, v, 1));
                if (std::max(std::abs(u - x), std::abs(v - y)) <= glare.reach()) {
                    nearby = std::max(nearby, value);
                } else {
                    // Rounding of the transforms alone: 1e-7 of what was put in, spread out.
                    ASSERT_LT(value, 60000 * 1e-7) << u << " " << v << " of " << x << " " << y;
                }
            }
        }
        EXPECT_GT(nearby, 100);
    }
}

TEST_F(DiffractionTest, IsWithinAHundredthOfItsReferenceInFlip) {
    constexpr int width = 640, height = 360;
    const GlareSettings settings = diffraction(0.2);
    const Image<double> light = night_lights(width, height);
    const Image8 reference = picture_of(light, reference_diffraction(light, settings));
    // The glare is there to be seen.
    EXPECT_GT(mean_flip(reference, picture_of(light, Image<double>(width, height, 3))), 0.03);
    double last = 0;
    for (const int most_side : {1024, 512, 256, 128}) {
        WaveGlare glare(shaders_, settings,
                        {.frame_width = width, .frame_height = height, .knobs = {.most_side = most_side}});
        const WaveResult result = run(glare, reduced(light, glare.scale()), width, height);
        const double error =
            mean_flip(reference, picture_of(light, enlarged(result.light, glare.scale(), width, height)));
        RecordProperty("flip_at_side_" + std::to_string(most_side), std::to_string(error));
        // The largest transform is what is used at the level `final`.
        if (most_side == 1024) {
            EXPECT_LT(error, 0.01);
        }
        EXPECT_GT(error, last) << most_side;
        last = error;
    }
}

TEST_F(DiffractionTest, EveryKnobsErrorFalls) {
    constexpr int width = 320, height = 180;
    const GlareSettings settings = diffraction(0.2);
    const Image<double> light = night_lights(width, height);
    const Image<double> reference = reference_diffraction(light, settings);
    const auto flip_of = [&](const WaveGlareOptions& options) {
        WaveGlare glare(shaders_, settings, options);
        const WaveResult result = run(glare, reduced(light, glare.scale()), width, height);
        return mean_flip(picture_of(light, reference),
                         picture_of(light, enlarged(result.light, glare.scale(), width, height)));
    };
    WaveGlareOptions options{.frame_width = width, .frame_height = height};
    double last = 1;
    for (const int wavelengths : {4, 8, 32}) {
        options.knobs.diffraction = {.aperture_side = 1024, .wavelengths = wavelengths};
        const double error = flip_of(options);
        EXPECT_LT(error, last) << wavelengths;
        last = error;
    }
    last = 1;
    for (const int side : {128, 256, 512}) {
        options.knobs.diffraction = {.aperture_side = side, .wavelengths = 64};
        const double error = flip_of(options);
        EXPECT_LT(error, last) << side;
        last = error;
    }
    last = 1;
    for (const bool half_float : {true, false}) {
        options.knobs.diffraction = converged_diffraction;
        options.knobs.full_float = !half_float;
        WaveGlare glare(shaders_, settings, options);
        const WaveResult result = run(glare, reduced(light, 1), width, height);
        const double error = relative_rms(reference, to_double(result.light));
        EXPECT_LT(error, last) << half_float;
        last = error;
    }
}

TEST_F(DiffractionTest, StandsExtremeLight) {
    constexpr int width = 64, height = 48;
    WaveGlare glare(shaders_, diffraction(0.2),
                    {.frame_width = width, .frame_height = height, .knobs = {.diffraction = coarse}});
    for (const float radiance : {0.0f, 1e-7f, 1.0f, 65504.0f, -65504.0f}) {
        ImageF light(width, height, 3);
        for (int c = 0; c < 3; ++c) light.at(32, 24, c) = radiance;
        const float kept = rounded_to_half(light).at(32, 24, 1);
        const WaveResult result = run(glare, light, width, height);
        for (const float sample : result.light.samples()) ASSERT_TRUE(std::isfinite(sample)) << radiance;
        // The least that half floats hold is 6e-8: texels below half of it vanish.
        EXPECT_NEAR(sum_of(result.light, 1), 0.2 * kept, 1e-3 * std::abs(0.2 * kept) + width * height * 3e-8)
            << radiance;
    }
    // All of the frame at the brightest: no overflow, and no more than the strength allows.
    const WaveResult full = run(glare, ImageF(width, height, 3, 65504), width, height);
    for (const float sample : full.light.samples()) ASSERT_LE(sample, 0.2f * 65504 * 1.001f);
    // What is no number stays out of it.
    ImageF broken(width, height, 3);
    broken.at(3, 3, 0) = std::numeric_limits<float>::quiet_NaN();
    broken.at(9, 9, 1) = 1000;
    for (const float sample : run(glare, broken, width, height).light.samples()) ASSERT_TRUE(std::isfinite(sample));
}

TEST_F(DiffractionTest, StandsFramesOfAllSizes) {
    for (const auto& [width, height] : {std::array{1, 1}, {7, 5}, {1, 300}, {3, 2}}) {
        WaveGlare glare(shaders_, diffraction(0.5),
                        {.frame_width = width, .frame_height = height, .knobs = {.diffraction = coarse}});
        ImageF light((width + glare.scale() - 1) / glare.scale(), (height + glare.scale() - 1) / glare.scale(), 3);
        light.at(0, 0, 1) = 100;
        const WaveResult result = run(glare, light, width, height);
        EXPECT_EQ(result.region, (Region{0, 0, light.width(), light.height()}));
        for (const float sample : result.light.samples()) ASSERT_TRUE(std::isfinite(sample));
        EXPECT_LE(sum_of(result.light, 1), 50.1);
        EXPECT_GT(sum_of(result.light, 1), 1);
    }
}

TEST_F(DiffractionTest, LargeFramesGetALargerScaleAndKeepTheTransformsLimit) {
    for (const auto& [width, height, most_side, scale] : {std::array{640, 360, 1024, 1},
                                                          {1920, 1080, 1024, 4},
                                                          {3840, 2160, 1024, 8},
                                                          {8192, 4320, 1024, 12},
                                                          {8192, 4320, 512, 20},
                                                          {8192, 4320, 2048, 8}}) {
        WaveGlare glare(
            shaders_, diffraction(0.2),
            {.frame_width = width, .frame_height = height, .knobs = {.most_side = most_side, .diffraction = coarse}});
        EXPECT_EQ(glare.scale(), scale) << width << " " << most_side;
        EXPECT_LE((width + glare.scale() - 1) / glare.scale() + glare.reach(), most_side);
    }
    // 8192 × 4320: a sun on the far corner, and the whole frame's width.
    WaveGlare glare(shaders_, diffraction(0.2),
                    {.frame_width = 8192, .frame_height = 4320, .knobs = {.most_side = 512, .diffraction = coarse}});
    ImageF light(410, 216, 3);
    light.at(409, 215, 1) = 5000;
    light.at(0, 0, 1) = 5000;
    const WaveResult result = run(glare, light, 8192, 4320);
    EXPECT_EQ(result.region, (Region{0, 0, 410, 216}));
    // A quarter of each stays in the frame, and the texel on the axes half and whole.
    EXPECT_GT(sum_of(result.light, 1), 0.2 * 10000 * 0.25);
    EXPECT_LT(sum_of(result.light, 1), 0.2 * 10000 * 0.6);
    EXPECT_LT(std::abs(result.light.at(200, 100, 1)), 0.01);
}

TEST_F(DiffractionTest, IsLeftOutWhereNothingIsBright) {
    constexpr int width = 64, height = 48;
    WaveGlare glare(shaders_, diffraction(),
                    {.frame_width = width, .frame_height = height, .knobs = {.diffraction = coarse}});
    ImageF light(width, height, 3);
    const auto sum_with = [&](bool met) {
        const Texture2D texture = upload(light);
        graph_.begin_frame(width, height);
        const GraphTexture source =
            graph_.import(&texture, {.format = GL_RGBA16F, .region = {0, 0, width, height}, .scale = 1});
        bright_.set(met);
        const GraphTexture sum =
            add_spill_sum(graph_, shaders_, {{add_wave_glare(graph_, source, bright_, glare), &bright_}});
        graph_.output(sum);
        graph_.run();
        return graph_.texture(sum).read<float>({0, 0, width, height}, 3);
    };
    // A bright frame leaves its glare in the pool's textures.
    light.at(20, 20, 1) = 50000;
    const ImageF bright = sum_with(true);
    EXPECT_GT(sum_of(bright, 1), 1000);
    // A dark one: what is left out adds the same bits as what is drawn.
    light = ImageF(width, height, 3);
    const ImageF drawn = sum_with(true);
    const ImageF left_out = sum_with(false);
    for (std::size_t i = 0; i < drawn.samples().size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(drawn.samples()[i] + 0.0f),
                  std::bit_cast<std::uint32_t>(left_out.samples()[i] + 0.0f));
    }
    const auto reports = graph_.reports();
    const auto convolution = std::find_if(reports.begin(), reports.end(), [](const PassReport& report) {
        return report.name == "glare/convolution 128x64";
    });
    ASSERT_NE(convolution, reports.end());
    EXPECT_FALSE(convolution->drawn);
    EXPECT_EQ(convolution->why, "no light above the threshold");
}

TEST_F(DiffractionTest, TakesTheLightOverTheThresholdThatWasAdded) {
    constexpr int width = 60, height = 40;
    GlareSettings settings = diffraction(1);
    settings.threshold = 4;
    settings.knee = 0;
    WaveGlare glare(
        shaders_, settings,
        {.frame_width = width, .frame_height = height, .knobs = {.full_float = true, .diffraction = coarse}});
    ImageF after(width, height, 4, 3.0F);  // below the threshold
    ImageF before(width, height, 3, 3.0F);
    const auto sum_with = [&](double object_strength) {
        Texture2D after_texture({.format = GL_RGBA32F, .width = width, .height = height});
        Texture2D before_texture({.format = GL_RGB32F, .width = width, .height = height});
        after_texture.upload(after);
        before_texture.upload(before);
        graph_.begin_frame(width, height);
        const FrameLight light{.after = graph_.import(&after_texture, {GL_RGBA32F, {0, 0, width, height}, 1}),
                               .before = graph_.import(&before_texture, {GL_RGB32F, {0, 0, width, height}, 1})};
        const GraphTexture added =
            add_wave_glare(graph_, {.light = light, .object_strength = object_strength}, bright_, glare);
        graph_.output(added);
        graph_.run();
        if (!bright_.is_met()) return 0.0;
        return sum_of(graph_.texture(added).read<float>({0, 0, width, height}, 3), 1);
    };
    EXPECT_EQ(sum_with(1), 0);
    // A lamp of 10 that an object hides takes its glare along. It fills a firefly's block, so that all of it counts.
    const auto set_lamp = [](ImageF& image) {
        for (int y = 20; y < 24; ++y) std::fill_n(image.pixel(28, y), 4 * image.channels(), 10.0F);
    };
    set_lamp(before);
    // D is of half floats: up to 2^-10 of it is cut.
    EXPECT_NEAR(sum_with(1), -16 * 6, 1e-3 * 16 * 6);
    // One that an object sends counts with the strength of dazzling reflection.
    before = ImageF(width, height, 3, 3.0F);
    set_lamp(after);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) after.at(x, y, 3) = after.at(x, y, 0) > 3 ? 1 : 0;
    }
    EXPECT_NEAR(sum_with(2.5), 16 * 15, 1e-3 * 16 * 15);
}

TEST_F(DiffractionTest, RefusesKnobsOutOfRange) {
    for (const WaveGlareKnobs& knobs :
         {WaveGlareKnobs{.least_scale = 3}, WaveGlareKnobs{.most_side = 4096}, WaveGlareKnobs{.most_side = 8},
          WaveGlareKnobs{.diffraction = {.aperture_side = 1000}}, WaveGlareKnobs{.diffraction = {.wavelengths = 1}},
          WaveGlareKnobs{.halo = {.samples = 0}}}) {
        EXPECT_THROW(knobs.check(), std::invalid_argument);
    }
    for (const QualityLevel level :
         {QualityLevel::draft, QualityLevel::preview, QualityLevel::final_, QualityLevel::reference}) {
        EXPECT_NO_THROW(wave_glare_knobs(level).check());
    }
}

TEST_F(DiffractionTest, SaysWhyItHasNothingToAdd) {
    graph_.begin_frame(64, 64);
    WaveGlare off(shaders_, diffraction(0), {.frame_width = 64, .frame_height = 64});
    EXPECT_TRUE(off.empty());
    EXPECT_FALSE(add_wave_glare(graph_, GraphTexture{}, bright_, off));
    WaveGlare on(shaders_, diffraction(1), {.frame_width = 64, .frame_height = 64, .knobs = {.diffraction = coarse}});
    EXPECT_FALSE(add_wave_glare(graph_, GraphTexture{}, bright_, on));
    graph_.run();
    const auto reports = graph_.reports();
    ASSERT_EQ(reports.size(), 2U);
    EXPECT_EQ(reports[0].why, "its strength is 0");
    EXPECT_EQ(reports[1].why, "nothing virtual is seen");
}

TEST_F(DiffractionTest, TransformsItsKernelOnceAndNeverUsesAnothers) {
    constexpr int side = 40;
    ImageF light(side, side, 3);
    light.at(20, 20, 1) = 100;
    const WaveGlareOptions options{.frame_width = side, .frame_height = side, .knobs = {.diffraction = coarse}};
    WaveGlare weak(shaders_, diffraction(0.1), options);
    const auto kernel_report = [](const WaveResult& result) { return result.reports.at(0); };
    const WaveResult first = run(weak, light, side, side);
    EXPECT_EQ(kernel_report(first).name, "glare/kernel 64x64");
    EXPECT_EQ(kernel_report(first).why, "once for the clip");
    const WaveResult second = run(weak, light, side, side);
    EXPECT_FALSE(kernel_report(second).drawn);
    EXPECT_TRUE(std::equal(first.light.samples().begin(), first.light.samples().end(), second.light.samples().begin()));
    // Settings changed in the preview: another glare of the same name in the same graph.
    WaveGlare strong(shaders_, diffraction(0.4), options);
    const WaveResult third = run(strong, light, side, side);
    EXPECT_TRUE(kernel_report(third).drawn);
    EXPECT_NEAR(sum_of(third.light, 1), 4 * sum_of(first.light, 1), 1e-3 * sum_of(third.light, 1));
}

}  // namespace
}  // namespace matchlight
