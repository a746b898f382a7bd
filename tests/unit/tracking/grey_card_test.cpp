// Paper, ink and noise read from drawn cards.
#include "tracking/grey_card.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

#include "core/transfer.h"
#include "media/av_pointers.h"
#include "media/plate_format.h"
#include "synthetic_view.h"
#include "tracking/noise_fit.h"

namespace matchlight {
namespace {

struct Sensor {
    double read = 0, shot = 0;
    unsigned seed = 1;
};

/// An 8-bit picture of a lit card as a frame of footage, with noise on the light.
PlateFrame photographed(const ImageF& albedo, const std::array<double, 3>& light, const Sensor& sensor = {}) {
    std::shared_ptr<AVFrame> samples = allocated_frame(albedo.width(), albedo.height(), AV_PIX_FMT_RGB24);
    std::mt19937 random(sensor.seed);
    std::normal_distribution<double> normal(0, 1);
    for (int y = 0; y < albedo.height(); ++y) {
        for (int x = 0; x < albedo.width(); ++x) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double clean = albedo.at(x, y) * light[c];
                const double noise = std::sqrt(sensor.read * sensor.read + sensor.shot * clean) * normal(random);
                const double code = srgb_code_from_linear(std::clamp(clean + noise, 0.0, 1.0));
                samples->data[0][y * samples->linesize[0] + 3 * x + static_cast<int>(c)] =
                    static_cast<std::uint8_t>(std::lround(255 * code));
            }
        }
    }
    PlateFormat format = plate_format_of(*samples, 0, {}, "card.png");
    return {std::move(samples), std::move(format), 0, 0};
}

/// A tag before a camera, fitted as the tracker fits it.
struct DrawnCard {
    test::SyntheticView view;
    test::SyntheticTag tag;
    ImageF albedo;
    LensGrid lens{test::ordinary_camera()};
    TagImageFit fit;
    PlateLight plate_light{Response::srgb(), Transfer::camera};

    DrawnCard() {
        view.camera = test::ordinary_camera();
        view.camera_from_world = test::orbit_pose(0.3, 35, 20, 0);
        view.paper = 0.8, view.ink = 0.04, view.blur_px = 0.8;
        tag.pattern = TagFamily("tag36h11").pattern(3);
        albedo = test::render_light(view, {tag});
        fit = fit_tag({albedo, 0, 0, lens, 2}, tag.pattern, test::rough_detection(view, tag, 0.5)).value();
    }
    std::optional<CardReading> read(const PlateFrame& frame) const {
        return read_card(frame, plate_light, lens, tag.pattern, fit);
    }
};

TEST(GreyCard, ReadsPaperMinusInk) {
    const DrawnCard card;
    const std::array<double, 3> light{0.9, 0.8, 0.5};
    const auto reading = card.read(photographed(card.albedo, light));
    ASSERT_TRUE(reading);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_TRUE(reading->difference[c].usable);
        // 8-bit codes of paper are 0.9 % apart in light, so a mean of equal pixels may be off by half of that.
        EXPECT_NEAR(reading->difference[c].light, 0.76 * light[c], 0.006 * light[c]);
        EXPECT_NEAR(reading->ink[c].light, 0.04 * light[c], 0.002);
    }
    // Overexposed in red: that channel only bounds the light from below.
    const auto bright = card.read(photographed(card.albedo, {1.4, 0.8, 0.5}));
    ASSERT_TRUE(bright);
    EXPECT_FALSE(bright->difference[0].usable);
    EXPECT_TRUE(bright->difference[1].usable);
    EXPECT_TRUE(bright->ink[0].usable);
}

TEST(GreyCard, AShadowOverAThirdOfTheTagMovesItLittle) {
    DrawnCard card;
    const auto corners = test::true_corners_px(card.view, card.tag);
    const double left = corners.row(0).minCoeff(), right = corners.row(0).maxCoeff();
    for (int y = 0; y < card.albedo.height(); ++y) {
        for (int x = 0; x < static_cast<int>(left + 0.3 * (right - left)); ++x) card.albedo.at(x, y) *= 0.6f;
    }
    const auto reading = card.read(photographed(card.albedo, {0.9, 0.9, 0.9}, {0.004, 0.0005}));
    ASSERT_TRUE(reading);
    EXPECT_NEAR(reading->difference[1].light / (0.76 * 0.9), 1, 0.03);
}

TEST(GreyCard, NoiseOfTheSensorIsFoundAgain) {
    const DrawnCard card;
    for (const Sensor& sensor : {Sensor{0.006, 0.0004}, Sensor{0, 0.0012}, Sensor{0.012, 0}}) {
        std::vector<std::vector<CardReading>> readings;
        for (unsigned f = 0; f < 5; ++f) {
            Sensor noisy = sensor;
            noisy.seed = f + 1;
            const double exposure = std::exp2(-0.4 * f);
            const auto reading =
                card.read(photographed(card.albedo, {0.95 * exposure, 0.9 * exposure, 0.6 * exposure}, noisy));
            ASSERT_TRUE(reading);
            readings.push_back({*reading});
        }
        const auto fit = fit_noise(readings, card.plate_light);
        ASSERT_TRUE(fit);
        for (const double light : {0.03, 0.1, 0.3, 0.7}) {
            const double expected = std::sqrt(sensor.read * sensor.read + sensor.shot * light);
            const double found = std::sqrt(fit->read * fit->read + fit->shot * light);
            EXPECT_NEAR(found / expected, 1, 0.15) << sensor.read << " " << sensor.shot << " at " << light;
        }
        EXPECT_NEAR(fit->neighbour_correlation, 0, 0.1);
    }
}

TEST(GreyCard, GrainOfPaperIsNoNoiseOfTheSensor) {
    DrawnCard card;
    std::mt19937 random(7);
    std::normal_distribution<float> grain(1, 0.03f);  // the same in all channels
    for (float& sample : card.albedo.samples()) sample *= grain(random);
    const Sensor sensor{0.004, 0.0005};
    const auto reading = card.read(photographed(card.albedo, {0.9, 0.8, 0.6}, sensor));
    ASSERT_TRUE(reading);
    const auto fit = fit_noise({{*reading}}, card.plate_light);
    ASSERT_TRUE(fit);
    for (const double light : {0.03, 0.6}) {
        const double expected = std::sqrt(sensor.read * sensor.read + sensor.shot * light);
        EXPECT_NEAR(std::sqrt(fit->read * fit->read + fit->shot * light) / expected, 1, 0.15) << light;
    }
}

TEST(NoiseFit, DirtAndEdgesDoNotCount) {
    std::vector<NoiseSample> samples;
    for (int i = 0; i < 200; ++i) {
        const double signal = i % 2 == 0 ? 0.02 + 0.0001 * i : 0.4 + 0.001 * i;
        const double dirt = i % 5 == 0 ? 8 : 1;
        samples.push_back({signal, dirt * (1e-5 + 6e-4 * signal), 100});
    }
    const auto fit = fit_noise(samples);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->read, std::sqrt(1e-5), 0.1 * std::sqrt(1e-5));
    EXPECT_NEAR(fit->shot, 6e-4, 0.1 * 6e-4);
}

TEST(NoiseFit, OneLevelOfLightDoesNotTellReadFromShot) {
    EXPECT_FALSE(fit_noise(std::vector<NoiseSample>(50, NoiseSample{0.5, 1e-4, 100})));
    EXPECT_FALSE(fit_noise(std::vector<NoiseSample>{}));
}

}  // namespace
}  // namespace matchlight
