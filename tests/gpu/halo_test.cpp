// The lenticular halo on the GPU against its double-precision reference, alone and beside diffraction.
#include <gtest/gtest.h>

#include "report/diffraction_reference.h"
#include "report/halo_reference.h"
#include "wave_fixture.h"

namespace matchlight {
namespace {

constexpr int width = 320, height = 180;
constexpr double focal_px = 300;

GlareSettings halo_alone(double strength) {
    GlareSettings settings;
    settings.level = GlareLevel::streaks;  // made elsewhere
    settings.halo = strength;
    return settings;
}

class HaloTest : public WaveTest {
protected:
    WaveGlare make(const GlareSettings& settings, int least_scale = 1) {
        return {shaders_,
                settings,
                {.frame_width = width,
                 .frame_height = height,
                 .focal_px = focal_px,
                 .knobs = {.least_scale = least_scale}}};
    }
};

TEST_F(HaloTest, AgreesWithItsReference) {
    const Image<double> light = night_lights(width, height);
    const Image<double> reference = reference_halo(light, {.focal_px = focal_px, .strength = 0.1});
    const Image8 picture = picture_of(light, reference);
    EXPECT_GT(mean_flip(picture, picture_of(light, Image<double>(width, height, 3))), 0.03);
    double last = 0;
    for (const int scale : {1, 2, 4, 8}) {
        WaveGlare glare = make(halo_alone(0.1), scale);
        ASSERT_EQ(glare.scale(), scale);
        const WaveResult result = run(glare, reduced(light, scale), width, height);
        const Image<double> added = enlarged(result.light, scale, width, height);
        const double error = relative_rms(reference, added);
        EXPECT_GT(error, last) << scale;
        last = error;
        if (scale == 1) {
            EXPECT_LT(error, 2e-3);  // half floats, and 32 wavelengths for 128
            EXPECT_LT(mean_flip(picture, picture_of(light, added)), 0.01);
        }
    }
}

TEST_F(HaloTest, SharesOneConvolutionWithDiffraction) {
    const Image<double> light = night_lights(width, height);
    GlareSettings both = halo_alone(0.1);
    both.level = GlareLevel::diffraction;
    both.strength = 0.2;
    WaveGlare glare = make(both);
    const WaveResult result = run(glare, reduced(light, 1), width, height);
    Image<double> reference = reference_diffraction(light, both);
    const Image<double> halo = reference_halo(light, {.focal_px = focal_px, .strength = 0.1});
    for (std::size_t i = 0; i < reference.samples().size(); ++i) reference.samples()[i] += halo.samples()[i];
    EXPECT_LT(mean_flip(picture_of(light, reference), picture_of(light, to_double(result.light))), 0.01);
    int convolutions = 0;
    for (const PassReport& report : result.reports) {
        if (report.name.find("convolution") != std::string::npos) ++convolutions;
    }
    EXPECT_EQ(convolutions, 1);
}

TEST_F(HaloTest, KeepsTheEnergyOfTheLight) {
    ImageF light(width, height, 3);
    for (int c = 0; c < 3; ++c) light.at(width / 2, height / 2, c) = 40000;
    WaveGlare glare = make(halo_alone(0.25));
    const WaveResult result = run(glare, light, width, height);
    for (int c = 0; c < 3; ++c) {
        // Half floats of the result lose up to 2^-10 of each texel: some drivers cut instead of rounding.
        EXPECT_NEAR(sum_of(result.light, c), 0.25 * 40000, 0.25 * 40000 * 1e-3);
    }
}

TEST_F(HaloTest, IsNothingWithoutStrength) {
    WaveGlare glare = make(halo_alone(0));
    EXPECT_TRUE(glare.empty());
}

}  // namespace
}  // namespace matchlight
