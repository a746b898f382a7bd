// HDR-FLIP against its authors' tool and by its own definition.
#include "report/hdr_flip.h"

#include <cmath>

#include <gtest/gtest.h>

#include "report/image_error.h"

namespace matchlight {
namespace {

/// A picture of 64 × 48 whose light spans eleven powers of two in blocks of 8 × 8; every value is exact in float.
ImageF blocks_of_light() {
    ImageF image(64, 48, 3);
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c) {
                const float detail = 1.0F + static_cast<float>((x * 13 + y * 29) % 17) / 16.0F;
                image.at(x, y, c) = std::ldexp(detail, (x / 8 * 7 + y / 8 * 3 + c * 5) % 11 - 4);
            }
        }
    }
    return image;
}

/// The same with a pattern over it and one bright pixel.
ImageF disturbed(const ImageF& image) {
    ImageF other = image;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                other.at(x, y, c) *= 1.0F + static_cast<float>((x * 5 + y * 11 + c) % 9) / 32.0F;
                if (x == 20 && y == 20) other.at(x, y, c) += 64.0F;
            }
        }
    }
    return other;
}

ImageF scaled(ImageF image, float factor) {
    for (float& value : image.samples()) value *= factor;
    return image;
}

TEST(HdrFlip, AgreesWithItsAuthorsTool) {
    // FLIP.h of NVlabs/flip, version 1.7, HDR with its defaults, on the same two pictures.
    const ImageF reference = blocks_of_light();
    const ExposureRange range = hdr_flip_exposures(reference);
    EXPECT_NEAR(range.start_ev, -5.448714, 1e-5);
    EXPECT_NEAR(range.stop_ev, -2.220520, 1e-5);
    EXPECT_EQ(range.count, 4);
    const ImageF map = hdr_flip_error_map(reference, disturbed(reference));
    EXPECT_NEAR(masked_mean(map).value(), 0.16700529, 2e-5);
    EXPECT_NEAR(map.at(20, 20), 0.45257106, 2e-4);
    EXPECT_NEAR(map.at(5, 40), 0.15918994, 2e-4);
    EXPECT_NEAR(map.at(60, 3), 0.15630740, 2e-4);
}

TEST(HdrFlip, OfAPictureWithItselfIsNothing) {
    const ImageF image = blocks_of_light();
    const ImageF map = hdr_flip_error_map(image, image);
    for (const float error : map.samples()) EXPECT_EQ(error, 0);
}

TEST(HdrFlip, IsTheLargestOfTheToneMappedErrors) {
    const ImageF reference = blocks_of_light(), test = disturbed(reference);
    const ExposureRange range = hdr_flip_exposures(reference);
    const ImageF map = hdr_flip_error_map(reference, test);
    ImageF largest(64, 48, 1);
    for (int i = 0; i < range.count; ++i) {
        const double ev = range.start_ev + i * (range.stop_ev - range.start_ev) / (range.count - 1);
        const ImageF at_ev = flip_error_map_of_light(tone_mapped(reference, ev), tone_mapped(test, ev));
        for (std::size_t k = 0; k < largest.samples().size(); ++k) {
            largest.samples()[k] = std::max(largest.samples()[k], at_ev.samples()[k]);
        }
    }
    for (std::size_t k = 0; k < largest.samples().size(); ++k) EXPECT_EQ(map.samples()[k], largest.samples()[k]);
}

TEST(HdrFlip, DoesNotDependOnTheUnitOfLight) {
    const ImageF reference = blocks_of_light(), test = disturbed(reference);
    const double here = masked_mean(hdr_flip_error_map(reference, test)).value();
    for (const float factor : {1e-6F, 0.25F, 1e6F}) {
        const double there = masked_mean(hdr_flip_error_map(scaled(reference, factor), scaled(test, factor))).value();
        EXPECT_NEAR(there, here, 1e-5) << factor;
    }
}

TEST(HdrFlip, SeesWhatOneExposureClips) {
    // Two suns far above white, one twice the other: no difference on a display at 0 EV, one by HDR-FLIP.
    ImageF reference(48, 48, 3, 0.2F), test = reference;
    for (int y = 20; y < 28; ++y) {
        for (int x = 20; x < 28; ++x) {
            for (int c = 0; c < 3; ++c) {
                reference.at(x, y, c) = 1000;
                test.at(x, y, c) = 2000;
            }
        }
    }
    EXPECT_EQ(masked_mean(flip_error_map_of_light(reference, test)).value(), 0);
    EXPECT_GT(hdr_flip_error_map(reference, test).at(24, 24), 0.05);
}

TEST(HdrFlip, ToneCurveIsMonotoneAndEndsAtWhite) {
    ImageF light(60, 1, 3);
    for (int x = 0; x < 60; ++x) {
        for (int c = 0; c < 3; ++c) light.at(x, 0, c) = std::exp2(static_cast<float>(x) - 30.0F);
    }
    const ImageF mapped = tone_mapped(light, 0);
    for (int x = 1; x < 60; ++x) EXPECT_GE(mapped.at(x, 0, 1), mapped.at(x - 1, 0, 1));
    EXPECT_EQ(mapped.at(59, 0, 0), 1);
    EXPECT_EQ(tone_mapped(ImageF(1, 1, 3, -1.0F), 5).at(0, 0, 0), 0);
    EXPECT_EQ(tone_mapped(ImageF(1, 1, 3, 3e38F), 1000).at(0, 0, 0), 1);
}

TEST(HdrFlip, TakesDarkPicturesAsTheyCome) {
    const ImageF black(32, 32, 3);
    EXPECT_EQ(hdr_flip_exposures(black).count, 1);
    EXPECT_EQ(masked_mean(hdr_flip_error_map(black, black)).value(), 0);
    // A lamp in the dark: the median is that of the lit pixels.
    ImageF lamp = black;
    for (int c = 0; c < 3; ++c) lamp.at(5, 5, c) = 10;
    const ExposureRange range = hdr_flip_exposures(lamp);
    EXPECT_TRUE(std::isfinite(range.start_ev) && std::isfinite(range.stop_ev));
    EXPECT_GT(masked_mean(hdr_flip_error_map(lamp, black)).value(), 0);
}

}  // namespace
}  // namespace matchlight
