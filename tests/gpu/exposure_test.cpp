// Exposure control: what the meter reads, how it adapts, and what the tone curve makes of it.
#include "render/effects/exposure.h"

#include <cmath>
#include <limits>
#include <random>

#include "gl_fixture.h"
#include "render/effects/exposure_meter.h"
#include "report/exposure_reference.h"

namespace matchlight {
namespace {

class ExposureMeter : public GlTest {
protected:
    ImageF map_of(const ImageF& light, int block_px) {
        Texture2D texture({.format = GL_RGBA32F, .width = light.width(), .height = light.height()});
        texture.upload(light);
        RenderGraph graph;
        graph.begin_frame(light.width(), light.height());
        const GraphTexture drawn = graph.import(&texture, {GL_RGBA32F, light.bounds(), 1});
        const GraphTexture map = add_exposure_meter(graph, shaders_, drawn, block_px);
        graph.output(map);
        graph.run();
        const Region region = graph.shape(map).region;
        return graph.texture(map).read<float>({0, 0, region.width, region.height}, 3);
    }
    MeterReading read(const ImageF& light, int block_px) { return read_meter(map_of(light, block_px), settings_); }
    ReferenceMeter reference(const ImageF& light) const {
        return reference_meter(light, black_luminance, settings_.darkest_share, settings_.brightest_share);
    }

    ShaderLibrary shaders_;
    ExposureSettings settings_;
};

ImageF grey(int width, int height, float value) {
    return ImageF(width, height, 4, value);
}

// log₂ on the GPU is good to a few units in the last place of values up to 40.
constexpr double log_tolerance = 1e-5;

TEST_F(ExposureMeter, ReadsEvenLightOfAnySizeAndBrightness) {
    for (const auto& [width, height] : {std::pair(1, 1), {7, 5}, {640, 360}}) {
        for (const float value : {1e-8F, 0.18F, 65504.0F, 1e9F}) {
            const MeterReading reading = read(grey(width, height, value), meter_block_px(width, height));
            ASSERT_TRUE(reading.log2_average);
            EXPECT_NEAR(*reading.log2_average, std::log2(value), log_tolerance * 10) << width << ' ' << value;
            EXPECT_NEAR(*reading.log2_maximum, std::log2(value), log_tolerance * 10);
        }
    }
}

TEST_F(ExposureMeter, IsNotPulledByBlackPixels) {
    for (const double share : {0.1, 0.5, 0.9}) {
        ImageF light = grey(100, 100, 0.25F);
        for (int y = 0; y < static_cast<int>(100 * share); ++y) std::ranges::fill(light.row(y), 0.0F);
        for (const int block_px : {1, 7}) EXPECT_NEAR(*read(light, block_px).log2_average, -2, log_tolerance);
    }
}

TEST_F(ExposureMeter, ReadsNothingInTheDark) {
    EXPECT_FALSE(read(grey(64, 48, 0), 4).log2_average);
    EXPECT_FALSE(read(grey(64, 48, -1), 4).log2_maximum);
}

TEST_F(ExposureMeter, LeavesOutWhatIsNotANumber) {
    ImageF light = grey(64, 48, 0.5F);
    for (int x = 0; x < 64; ++x) {
        light.at(x, 3, 0) = std::numeric_limits<float>::quiet_NaN();
        light.at(x, 9, 1) = std::numeric_limits<float>::infinity();
        light.at(x, 15, 2) = -std::numeric_limits<float>::infinity();
    }
    const MeterReading reading = read(light, 8);
    EXPECT_NEAR(*reading.log2_average, -1, log_tolerance);
    EXPECT_NEAR(*reading.log2_maximum, -1, log_tolerance);
}

TEST_F(ExposureMeter, FindsASunOfOnePixelAndIsNotBlindedByIt) {
    ImageF light = grey(640, 360, 0.18F);
    for (int c = 0; c < 3; ++c) light.at(401, 77, c) = 1e9F;
    const MeterReading reading = read(light, meter_block_px(640, 360));
    EXPECT_NEAR(*reading.log2_maximum, std::log2(1e9), 1e-4);
    EXPECT_NEAR(*reading.log2_average, std::log2(0.18), log_tolerance);
}

TEST_F(ExposureMeter, AgreesWithTheReferencePixelByPixel) {
    std::mt19937 generator(5);
    std::lognormal_distribution<float> noise(-1, 2);
    ImageF light(120, 90, 4);
    for (float& value : light.samples()) value = noise(generator);
    EXPECT_NEAR(*read(light, 1).log2_average, *reference(light).log2_average, log_tolerance);
    EXPECT_NEAR(*read(light, 1).log2_maximum, *reference(light).log2_maximum, log_tolerance * 10);
    // In blocks only the trim can differ: without one all agree.
    settings_.darkest_share = settings_.brightest_share = 0;
    for (const int block_px : {2, 7, 200}) {
        EXPECT_NEAR(*read(light, block_px).log2_average, *reference(light).log2_average, log_tolerance) << block_px;
    }
}

TEST_F(ExposureMeter, GivesTheSameBitsEveryTime) {
    std::mt19937 generator(6);
    std::lognormal_distribution<float> noise(0, 3);
    ImageF light(333, 77, 4);
    for (float& value : light.samples()) value = noise(generator);
    const MeterReading first = read(light, 2);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(*read(light, 2).log2_average, *first.log2_average);
}

TEST(ExposureTrim, LeavesOutTheSharesOfPixelsAtEitherEnd) {
    ImageF map(3, 1, 3);  // 10 dark pixels, 80 middling ones, 10 bright ones
    const std::array<std::array<float, 3>, 3> texels{{{-50, 10, -5}, {0, 80, 0}, {90, 10, 9}}};
    for (int x = 0; x < 3; ++x) std::copy_n(texels[static_cast<std::size_t>(x)].begin(), 3, map.pixel(x, 0));
    ExposureSettings settings;
    settings.darkest_share = settings.brightest_share = 0;
    EXPECT_NEAR(*read_meter(map, settings).log2_average, 0.4, 1e-12);
    settings.brightest_share = 0.1;
    EXPECT_NEAR(*read_meter(map, settings).log2_average, -50.0 / 90, 1e-12);
    settings.darkest_share = 0.05;  // half of the dark ones
    EXPECT_NEAR(*read_meter(map, settings).log2_average, -25.0 / 85, 1e-12);
    EXPECT_EQ(*read_meter(map, settings).log2_maximum, 9);
}

TEST(ExposureAdaptation, IsTheClosedFormAtAnyStep) {
    for (const double steps : {1e-3, 0.1, 1.0, 2.1, 3.0, 1e3, 1e6}) {
        for (const double target : {-20.0, -1.0, 1.0, 30.0}) {
            ExposureSettings settings;
            settings.to_light_s = 0.7;
            settings.to_dark_s = 3;
            const double time_constant_s = target > 0 ? 0.7 : 3.0;
            const double expected = reference_adaptation(0, target, steps * time_constant_s, time_constant_s);
            const double found = adapted(0, target, steps * time_constant_s, settings);
            EXPECT_NEAR(found / expected, 1, 1e-12) << steps;
            EXPECT_LE(std::abs(found), std::abs(target));  // never beyond
        }
    }
}

TEST(ExposureAdaptation, FollowsAStepWhateverTheTimeStamps) {
    // A light goes on after the first frame; frames come when they like.
    std::mt19937 generator(8);
    std::uniform_real_distribution<double> gap(1e-4, 0.4);
    std::vector<double> times_s{0};
    std::vector<MeterReading> readings{{-3.0, 0.0}};
    while (times_s.size() < 200) {
        times_s.push_back(times_s.back() + gap(generator));
        readings.push_back({2.0, 5.0});
    }
    ExposureSettings settings;
    const auto exposures = exposures_of_clip(readings, times_s, settings);
    for (std::size_t i = 0; i < times_s.size(); ++i) {
        const double average = reference_adaptation(-3, 2, times_s[i], settings.to_light_s);
        const double maximum = reference_adaptation(0, 5, times_s[i], settings.to_light_s);
        const double ev = std::log2(settings.key) - average;
        EXPECT_NEAR(exposures[i].ev, ev, 1e-12);
        EXPECT_NEAR(exposures[i].white, std::max(1.0, std::exp2(maximum + ev)), 1e-9);
    }
}

TEST(ExposureAdaptation, HoldsWhileTheFrameIsBlackAndStartsWithTheFirstThatIsNot) {
    const std::vector<MeterReading> readings{{}, {1.0, 2.0}, {}, {1.0, 2.0}};
    const auto exposures = exposures_of_clip(readings, {0, 1, 2, 3}, {});
    for (const FrameExposure& exposure : exposures) EXPECT_NEAR(exposure.ev, std::log2(0.18) - 1, 1e-12);
    const auto dark = exposures_of_clip({{}, {}}, {0, 1}, {});
    EXPECT_EQ(dark[1].ev, 0);
    EXPECT_EQ(dark[1].white, 1);
}

TEST(ExposureAdaptation, SurvivesTimeStampsThatStandStillOrRunBackwards) {
    const std::vector<MeterReading> readings{{0.0, 0.0}, {4.0, 4.0}, {4.0, 4.0}};
    const auto exposures = exposures_of_clip(readings, {1, 1, 0.5}, {});
    EXPECT_EQ(exposures[1].ev, exposures[0].ev);
    EXPECT_EQ(exposures[2].ev, exposures[0].ev);
    ExposureSettings at_once;
    at_once.to_light_s = 0;
    EXPECT_NEAR(exposures_of_clip(readings, {0, 1, 2}, at_once)[1].ev, std::log2(0.18) - 4, 1e-12);
}

TEST(ExposureAdaptation, CompensatesAndTakesAWhiteByHand) {
    ExposureSettings settings;
    settings.compensation_ev = 2;
    settings.white = 7;
    const auto exposures = exposures_of_clip({{0.0, 3.0}}, {0}, settings);
    EXPECT_NEAR(exposures[0].ev, std::log2(0.18) + 2, 1e-12);
    EXPECT_EQ(exposures[0].white, 7);
}

TEST(ToneCurve, IsTheReferenceAndTheIdentityAtWhiteOne) {
    for (const double luminance : {1e-8, 0.18, 1.0, 65504.0, 1e9}) {
        const Eigen::Vector3d light = luminance / 0.7152 * Eigen::Vector3d(0, 1, 0);
        for (const double white : {0.5, 1.0, 4.0, 1e6}) {
            const Eigen::Vector3d expected = reference_tone(light, white);
            EXPECT_NEAR(light.y() * tone_factor(luminance, white) / expected.y(), 1, 1e-12);
        }
        EXPECT_EQ(tone_factor(luminance, 1), 1);
        EXPECT_EQ(tone_factor(luminance, 0), 1);
    }
    EXPECT_NEAR(reference_tone(Eigen::Vector3d::Constant(4), 4).x(), 1, 1e-12);  // white becomes white
}

}  // namespace
}  // namespace matchlight
