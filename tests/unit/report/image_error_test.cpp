// PSNR, relative RMS and masked means on differences of known size.
#include "report/image_error.h"

#include <cmath>

#include <gtest/gtest.h>

#include "picture.h"
#include "report/change_region.h"

namespace matchlight {
namespace {

using test::flat_picture;
using test::noise_picture;

TEST(Psnr, KnownDifferences) {
    // One code everywhere: 10·log10(255²); sixteen codes: 20·log10(16) = 24.08 dB less.
    const Image8 grey = flat_picture(8, 8, 100, 100, 100);
    EXPECT_NEAR(psnr_db(grey, flat_picture(8, 8, 101, 101, 101)).value(), 48.130803608679, 1e-9);
    EXPECT_NEAR(psnr_db(grey, flat_picture(8, 8, 116, 116, 116)).value(), 24.048403955560, 1e-9);
    // One channel in three: a third of the mean square.
    EXPECT_NEAR(psnr_db(grey, flat_picture(8, 8, 101, 100, 100)).value(), 48.130803608679 + 10 * std::log10(3), 1e-9);
    EXPECT_NEAR(psnr_db(flat_picture(8, 8, 0, 0, 0), flat_picture(8, 8, 255, 255, 255)).value(), 0, 1e-12);
    EXPECT_EQ(psnr_db(grey, grey).value(), psnr_cap_db);
}

TEST(Psnr, CountsOnlyTheMask) {
    Image8 test = flat_picture(8, 8, 50, 50, 50);
    const Image8 reference = test;
    for (int c = 0; c < 3; ++c) test.at(3, 4, c) = 60;
    Image8 mask(8, 8, 1);
    EXPECT_FALSE(psnr_db(reference, test, &mask).has_value());
    mask.at(3, 4) = 1;
    EXPECT_NEAR(psnr_db(reference, test, &mask).value(), 28.130803608679, 1e-9);  // ten codes on every counted pixel
    const Image8 outside = inverted_mask(mask);
    EXPECT_EQ(psnr_db(reference, test, &outside).value(), psnr_cap_db);
    EXPECT_DOUBLE_EQ(mask_share(mask), 1.0 / 64);
    EXPECT_DOUBLE_EQ(mask_share(outside), 63.0 / 64);
}

TEST(RelativeRms, IsTheShareOfTheReferencesLight) {
    ImageF reference(4, 4, 3, 2.0f), test(4, 4, 3, 2.5f);
    EXPECT_DOUBLE_EQ(relative_rms(reference, test).value(), 0.25);
    EXPECT_DOUBLE_EQ(relative_rms(reference, reference).value(), 0);
    EXPECT_FALSE(relative_rms(ImageF(4, 4, 3), test).has_value());
}

TEST(MaskedMean, IsExactOnFewPixels) {
    ImageF map(3, 1, 1);
    map.at(0, 0) = 0.25f;
    map.at(1, 0) = 0.75f;
    map.at(2, 0) = 0.5f;
    EXPECT_DOUBLE_EQ(masked_mean(map).value(), 0.5);
    Image8 mask(3, 1, 1);
    mask.at(1, 0) = 255;
    EXPECT_DOUBLE_EQ(masked_mean(map, &mask).value(), 0.75);
    mask.at(1, 0) = 0;
    EXPECT_FALSE(masked_mean(map, &mask).has_value());
}

TEST(ChangeRegion, TakesWhatStandsOutAndLeavesNoise) {
    const Image8 plate = flat_picture(60, 60, 100, 100, 100);
    Image8 noisy = plate;
    const Image8 noise = noise_picture(60, 60, 7);
    for (std::size_t i = 0; i < noise.samples().size(); ++i) {
        noisy.samples()[i] = static_cast<std::uint8_t>(90 + noise.samples()[i] % 21);  // at most ten codes away
    }
    for (int c = 0; c < 3; ++c) noisy.at(10, 10, c) = 200;  // a lone pixel
    EXPECT_EQ(mask_share(change_region(plate, noisy)), 0);

    Image8 object = plate;
    for (int y = 28; y <= 32; ++y) {
        for (int x = 28; x <= 32; ++x) object.at(x, y, 1) = 111;  // eleven codes, in one channel
    }
    const Image8 region = change_region(plate, object);
    EXPECT_EQ(region.at(30, 30), 255);
    EXPECT_EQ(region.at(30 + 9, 30), 255);  // two of the square's half, seven of the dilation's
    EXPECT_EQ(region.at(30 + 10, 30), 0);
}

}  // namespace
}  // namespace matchlight
