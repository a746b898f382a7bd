// Merged radiance against the light that a synthetic camera was shown.
#include "calibration/hdr_merge.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "report/synthetic_bracket.h"

namespace matchlight {
namespace {

/// The shortest leaves the brightest light four deviations below full code.
const std::vector<double> five_exposures = {0.8, 4, 16, 64, 256};

class HdrMerge : public testing::Test {
protected:
    HdrMerge() { warnings_.set_quiet(true); }
    MergedPhotograph merge(const ImageF& radiance, const std::vector<double>& exposures, const SyntheticCamera& camera,
                           const MergeOptions& options = {}) {
        return merge_exposures(photographed(radiance, exposures, camera), camera.response, options, warnings_);
    }
    bool warned(const std::string& part) const {
        const auto entries = warnings_.entries();
        return std::any_of(entries.begin(), entries.end(),
                           [&](const auto& entry) { return entry.text.find(part) != std::string::npos; });
    }
    Warnings warnings_;
};

/// Over the columns from `first` to before `last`, where light is nearly one value each: mean of log2(merged / true),
/// and mean of ((merged − true) / sigma)².
struct MergeError {
    double bias_ev = 0, chi_square = 0;
};
MergeError error_over(const MergedPhotograph& merged, const ImageF& radiance, int first, int last) {
    double sum = 0, truth = 0, chi = 0;
    int count = 0;
    for (int y = 0; y < radiance.height(); ++y) {
        for (int x = first; x < last; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double expected = radiance.at(x, y, c), found = merged.radiance.at(x, y, c);
                const double deviation = (found - expected) / merged.sigma.at(x, y, c);
                sum += found;
                truth += expected;
                chi += deviation * deviation;
                ++count;
            }
        }
    }
    return {std::log2(sum / truth), chi / count};
}

TEST_F(HdrMerge, IsUnbiasedAndItsSigmaHonestOverSixteenStops) {
    const ImageF radiance = radiance_ramp(512, 128, 16);
    struct Case {
        const char* name;
        SyntheticCamera camera;
    };
    const Case cases[] = {{"sRGB, 8 bits", {}},
                          {"gamma 1.8", {Response::gamma(1.8)}},
                          {"noisy", {Response::srgb(), 0.004, 0.002}},
                          {"linear, 16 bits", {Response::gamma(1), 0.0005, 0.0002, 65535}}};
    for (const Case& tried : cases) {
        SCOPED_TRACE(tried.name);
        const MergedPhotograph merged = merge(radiance, five_exposures, tried.camera);
        // Each stop alone: 32 columns × 128 rows × 3 channels.
        for (int first = 0; first < 512; first += 32) {
            SCOPED_TRACE(first);
            const MergeError error = error_over(merged, radiance, first, first + 32);
            // Blue is the darkest. Within two deviations of black the camera itself shows too much on average: its
            // negative noise ends at code 0.
            const double darkest = radiance.at(first, 0, 2) * five_exposures.back();
            const SyntheticCamera& camera = tried.camera;
            const double variance = camera.read_noise * camera.read_noise + camera.shot_noise * darkest;
            if (darkest * darkest > 4 * variance) {
                EXPECT_NEAR(error.bias_ev, 0, 0.01);
            }
            EXPECT_GT(error.chi_square, 0.6);
            EXPECT_LT(error.chi_square, 1.5);
        }
        EXPECT_EQ(merged.clipped_pixels, 0);
        EXPECT_LT(merged.ghost_pixels, 512 * 128 / 500);
    }
}

TEST_F(HdrMerge, FindsTheNoiseOfTheCamera) {
    SyntheticCamera camera;
    camera.read_noise = 0.003;
    camera.shot_noise = 0.001;
    const MergedPhotograph merged = merge(radiance_ramp(512, 128, 14), five_exposures, camera);
    EXPECT_NEAR(merged.noise.read, 0.003, 0.0006);
    EXPECT_NEAR(merged.noise.shot, 0.001, 0.0002);
    EXPECT_LT(merged.noise.gain, 0.01);
}

TEST_F(HdrMerge, WhatIsClippedInEveryPhotographIsALowerBoundAndNeverBlack) {
    ImageF radiance(64, 64, 3, 0.3f);
    for (int y = 20; y < 30; ++y) {
        for (int x = 20; x < 30; ++x) std::fill_n(radiance.pixel(x, y), 3, 1e6f);  // a sun
    }
    const MergedPhotograph merged = merge(radiance, {0.25, 1, 4}, {});
    EXPECT_EQ(merged.clipped_pixels, 100);
    EXPECT_TRUE(warned("clipped even in this shortest exposure"));
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(merged.radiance.at(25, 25, c), 4, 0.2);  // full code at exposure 0.25
        EXPECT_EQ(merged.flags.at(25, 25, c) & merge_flag::clipped, merge_flag::clipped);
        EXPECT_EQ(merged.sigma.at(25, 25, c), merged.radiance.at(25, 25, c));
        EXPECT_EQ(merged.flags.at(5, 5, c) & merge_flag::clipped, 0);
        EXPECT_NEAR(merged.radiance.at(5, 5, c), 0.3, 0.055);  // five deviations of the camera's noise
    }
}

TEST_F(HdrMerge, AllWhiteIsABoundAllBlackIsNoise) {
    const MergedPhotograph white = merge(ImageF(32, 32, 3, 1e9f), {1, 4, 16}, {});
    const MergedPhotograph black = merge(ImageF(32, 32, 3, 0.0f), {1, 4, 16}, {});
    EXPECT_EQ(white.clipped_pixels, 32 * 32);
    EXPECT_FLOAT_EQ(white.radiance.at(3, 3, 1), 1);
    EXPECT_GT(black.under_noise_pixels, 32 * 32 * 8 / 10);  // a pixel in some lies a deviation up in all channels
    EXPECT_TRUE(warned("hardly a pixel stands out of the noise"));
    for (const float value : black.radiance.samples()) {
        EXPECT_GE(value, 0);
        EXPECT_LT(value, 0.002 / 16 * 5);
    }
    for (const float value : black.sigma.samples()) EXPECT_GT(value, 0);
}

TEST_F(HdrMerge, OnePhotographAloneIsItsOwnLight) {
    const ImageF radiance = radiance_ramp(128, 32, 6);
    const MergedPhotograph merged = merge(radiance, {0.9}, {});
    const MergeError error = error_over(merged, radiance, 64, 128);
    EXPECT_NEAR(error.bias_ev, 0, 0.01);
}

TEST_F(HdrMerge, ThingsThatMovedComeFromTheReferenceAlone) {
    const ImageF radiance = radiance_ramp(256, 128, 8);
    const SyntheticCamera camera;
    ExposureSeries series = photographed(radiance, {4, 16, 64}, camera);
    ImageF moved = radiance;
    for (int y = 40; y < 60; ++y) {
        for (int x = 100; x < 130; ++x) std::fill_n(moved.pixel(x, y), 3, 0.002f);
    }
    // One exposure alone shows a dark thing.
    const ExposureSeries other = photographed(moved, {4, 16, 64}, camera);
    series.shots[1].code = other.shots[1].code;
    const MergedPhotograph with = merge_exposures(series, camera.response, {}, warnings_);
    const MergedPhotograph without = merge_exposures(series, camera.response, {.deghost = false}, warnings_);
    ASSERT_NE(with.reference, 1u);
    double worst_with = 0, worst_without = 0;
    for (int y = 45; y < 55; ++y) {
        for (int x = 105; x < 125; ++x) {
            const double truth = radiance.at(x, y, 1);
            worst_with = std::max(worst_with, std::abs(std::log2(with.radiance.at(x, y, 1) / truth)));
            worst_without = std::max(worst_without, std::abs(std::log2(without.radiance.at(x, y, 1) / truth)));
            EXPECT_NE(with.flags.at(x, y, 1) & merge_flag::ghost, 0);
        }
    }
    EXPECT_LT(worst_with, 0.3);
    EXPECT_GT(worst_without, worst_with);
    EXPECT_LT(with.ghost_pixels, 36 * 26);  // the thing and its rim
}

TEST_F(HdrMerge, WhatOnlyGhostsHoldIsWhatTheyShow) {
    const SyntheticCamera camera;
    const std::vector<double> exposures = {0.25, 4, 64};
    // A lamp that only the shortest exposure holds, and that moves from one to the next: beside each of its places some
    // photograph disagrees, and masks of what disagrees reach beyond it.
    ExposureSeries series;
    for (int shot = 0; shot < 3; ++shot) {
        ImageF scene(128, 64, 3, 0.002f);
        for (int y = 20; y < 40; ++y) {
            for (int x = 60 - 4 * shot; x < 70 - 4 * shot; ++x) std::fill_n(scene.pixel(x, y), 3, 1.0f);
        }
        const ExposureSeries taken = photographed(scene, exposures, camera);
        if (shot == 0) series = taken;
        series.shots[static_cast<std::size_t>(shot)].code = taken.shots[static_cast<std::size_t>(shot)].code;
    }
    const MergedPhotograph merged = merge_exposures(series, camera.response, {}, warnings_);
    // Nothing is brighter than any photograph shows; full code of the shortest would be 4.
    EXPECT_LT(*std::ranges::max_element(merged.radiance.samples()), 1.2f);
    EXPECT_EQ(merged.clipped_pixels, 0);
}

/// The photograph after JPEG compression.
void compress(Photograph& shot, int quality) {
    cv::Mat picture(shot.code.height(), shot.code.width(), CV_8UC3);
    const auto codes = shot.code.samples();
    std::transform(codes.begin(), codes.end(), picture.data,
                   [](float code) { return static_cast<unsigned char>(std::lround(255 * code)); });
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
    std::transform(picture.data, picture.data + codes.size(), shot.code.samples().begin(),
                   [](unsigned char code) { return static_cast<float>(code) / 255; });
}

TEST_F(HdrMerge, SmallLampsKeepTheirLightThroughJpegAndTheSearchForGhosts) {
    // Lamps of all sizes from half a pixel to two, as a lens blurs them, a thousand times the wall.
    ImageF radiance(256, 192, 3, 0.2f);
    struct Lamp {
        double x, y, sigma_px;
    };
    const std::vector<Lamp> lamps = {{40.3, 40.6, 0.6}, {100.7, 50.2, 0.9}, {170.1, 60.4, 1.3}, {90.5, 130.8, 2.0}};
    for (const Lamp& lamp : lamps) {
        for (int y = 0; y < radiance.height(); ++y) {
            for (int x = 0; x < radiance.width(); ++x) {
                const double distance = std::hypot(x - lamp.x, y - lamp.y) / lamp.sigma_px;
                for (int c = 0; c < 3; ++c)
                    radiance.at(x, y, c) += static_cast<float>(200 * std::exp(-distance * distance / 2));
            }
        }
    }
    const auto light_of = [&](const Lamp& lamp, const ImageF& picture) {
        double sum = 0;
        for (int y = static_cast<int>(lamp.y) - 10; y <= static_cast<int>(lamp.y) + 10; ++y) {
            for (int x = static_cast<int>(lamp.x) - 10; x <= static_cast<int>(lamp.x) + 10; ++x)
                sum += picture.at(x, y, 1);
        }
        return sum;
    };
    for (const int quality : {92, 60}) {
        ExposureSeries series = photographed(radiance, {4, 1, 0.25, 1.0 / 16, 1.0 / 64, 1.0 / 256}, {});
        for (Photograph& shot : series.shots) compress(shot, quality);
        const MergedPhotograph with =
            merge_exposures(series, Response::srgb(), {.align = Alignment::off, .deghost = true}, warnings_);
        const MergedPhotograph without =
            merge_exposures(series, Response::srgb(), {.align = Alignment::off, .deghost = false}, warnings_);
        for (const Lamp& lamp : lamps) {
            SCOPED_TRACE(lamp.sigma_px);
            // Strong compression itself takes a tenth of the smallest; the search for ghosts must take nothing.
            EXPECT_NEAR(light_of(lamp, with.radiance) / light_of(lamp, without.radiance), 1, 0.01) << quality;
            if (quality > 90) {
                EXPECT_NEAR(light_of(lamp, with.radiance) / light_of(lamp, radiance), 1, 0.05);
            }
        }
    }
}

TEST_F(HdrMerge, WrongExposuresAreMeasuredWarnedOfAndRefined) {
    const ImageF radiance = radiance_ramp(256, 128, 10);
    ExposureSeries series = photographed(radiance, {1, 4, 16, 64}, {});
    series.shots[1].exposure *= 1.3;  // 0.379 EV more than was exposed
    series.shots[1].record.exposure_s *= 1.3;
    const MergedPhotograph as_said = merge_exposures(series, Response::srgb(), {}, warnings_);
    EXPECT_TRUE(warned("the exposures or the response are wrong"));
    ASSERT_EQ(as_said.agreements.size(), 3u);
    EXPECT_NEAR(as_said.agreements[0].measured_ev, 2, 0.01);
    EXPECT_NEAR(as_said.agreements[1].measured_ev, 2, 0.01);
    EXPECT_NEAR(as_said.agreements[0].recorded_ev, 2 - std::log2(1.3), 1e-9);
    const MergedPhotograph refined = merge_exposures(series, Response::srgb(), {.refine_exposures = true}, warnings_);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(std::log2(refined.exposures[i] / refined.exposures[i + 1]), 2, 0.01);
}

TEST_F(HdrMerge, ACameraThatEndsBelowFullCodeIsSeenToClip) {
    SyntheticCamera camera;
    camera.full_code = 250.0 / 255;
    const ImageF radiance = radiance_ramp(256, 128, 10);
    const MergedPhotograph merged = merge(radiance, {1, 4, 16, 64}, camera);
    for (const float full : merged.full) EXPECT_NEAR(full, 250.0 / 255, 1e-6);
    for (int first = 0; first < 224; first += 32)
        EXPECT_NEAR(error_over(merged, radiance, first, first + 32).bias_ev, 0, 0.01);
}

TEST(NominalRounding, IsWhatScalesOfThirdsAndHalvesRound) {
    const auto between = [](double brighter_s, double darker_s) {
        return nominal_rounding_ev({brighter_s, 8, 100}, {darker_s, 8, 100});
    };
    // 1/30 is made as 1/32, 1/8 as it is: the step is 2 EV, not 1.907.
    EXPECT_NEAR(between(1.0 / 8, 1.0 / 30).most, std::log2(32.0 / 30), 1e-9);
    EXPECT_EQ(between(1.0 / 8, 1.0 / 30).least, 0);
    // Twice the same rounding leaves the step alone.
    EXPECT_NEAR(between(1.0 / 30, 1.0 / 60).most, 0, 1e-9);
    EXPECT_NEAR(between(1.0 / 30, 1.0 / 60).least, 0, 1e-9);
    // f/22 is made as f/22.6.
    EXPECT_NEAR(nominal_rounding_ev({0.1, 8, 100}, {0.1, 22, 100}).most, 2 * std::log2(std::sqrt(512.0) / 22), 1e-9);
}

}  // namespace
}  // namespace matchlight
