// Lamps of known place, size and power are found; what is no lamp is not.
#include "lighting/dominant_lights.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "synthetic_probes.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using test::furnace;
using test::probe_of;

constexpr double pi = std::numbers::pi;
const Vector3d lamp_towards = Vector3d(0.6, 0.64, 0.48);
const Vector3d window_towards = Vector3d(-0.8, 0.0, 0.6);

Vector3d room(const Vector3d& d) {
    // Caps of 4° and 12° radius.
    if (d.dot(lamp_towards) > std::cos(4 * pi / 180)) return {400, 300, 200};
    if (d.dot(window_towards) > std::cos(12 * pi / 180)) return {20, 22, 30};
    return {0.5, 0.4, 0.3};
}

double cap(double radius_deg) {
    return 2 * pi * (1 - std::cos(radius_deg * pi / 180));
}

TEST(DominantLights, HaveTheirPlaceSizeAndPower) {
    const auto lights = dominant_lights(probe_of(512, room));
    ASSERT_EQ(lights.size(), 2u);
    // Pixels of 0.35° draw the edge of a cap of 4° to 2 %, of 12° to 1 %; centroids average that out.
    EXPECT_LT(std::acos(std::min(1.0, lights[0].direction.dot(lamp_towards))), 0.05 * pi / 180);
    EXPECT_NEAR(lights[0].solid_angle_sr, cap(4), 0.02 * cap(4));
    EXPECT_NEAR(lights[0].power.y(), 300 * cap(4), 0.02 * 300 * cap(4));
    EXPECT_LT(std::acos(std::min(1.0, lights[1].direction.dot(window_towards))), 0.05 * pi / 180);
    EXPECT_NEAR(lights[1].solid_angle_sr, cap(12), 0.01 * cap(12));
    EXPECT_GT(lights[0].power_share, lights[1].power_share);
    EXPECT_LE(lights[0].power_share + lights[1].power_share, 1);
}

TEST(DominantLights, WrapAtTheSeam) {
    // A lamp straight behind lies on both ends of every row.
    const Probe probe = probe_of(128, [](const Vector3d& d) -> Vector3d {
        return Vector3d::Constant(d.y() < -std::cos(6 * pi / 180) ? 100.0 : 0.1);
    });
    const auto lights = dominant_lights(probe);
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_NEAR(lights[0].direction.y(), -1, 1e-4);
}

TEST(DominantLights, AHaloIsNoLampOfItsOwn) {
    // A sun in a glow that falls with the square of the angle: one light.
    const Probe probe = probe_of(256, [](const Vector3d& d) -> Vector3d {
        const double angle = std::acos(std::clamp(d.dot(lamp_towards), -1.0, 1.0));
        return Vector3d::Constant(0.05 + (angle < 0.03 ? 1e4 : 1.0 / (angle * angle)));
    });
    EXPECT_EQ(dominant_lights(probe).size(), 1u);
}

TEST(DominantLights, EvenAndBlackLightHaveNone) {
    EXPECT_TRUE(dominant_lights(furnace(32, 1)).empty());
    EXPECT_TRUE(dominant_lights(furnace(32, 0)).empty());
    EXPECT_TRUE(dominant_lights(probe_of(32, test::smooth_sky)).empty());
}

TEST(ProbeStatistics, AreThoseOfTheSphere) {
    // The upper half 3, the lower 1: the mean is 2, whatever the rows crowd at the poles.
    const Probe probe =
        probe_of(64, [](const Vector3d& d) -> Vector3d { return Vector3d::Constant(d.z() > 0 ? 3 : 1); });
    const ProbeStatistics statistics = probe_statistics(probe);
    EXPECT_NEAR(statistics.mean_luminance, 2, 1e-9);
    EXPECT_NEAR(statistics.dynamic_range_ev(), std::log2(3.0), 1e-9);
    EXPECT_EQ(statistics.black_share, 0);
    // 60 % black by solid angle: the median is black, the least positive is not.
    const ProbeStatistics dark = probe_statistics(
        probe_of(250, [](const Vector3d& d) -> Vector3d { return Vector3d::Constant(d.z() > 0.2 ? 2 : 0); }));
    EXPECT_NEAR(dark.black_share, 0.6, 0.01);
    EXPECT_EQ(dark.median_luminance, 0);
    EXPECT_NEAR(dark.least_positive_luminance, 2, 1e-9);
    EXPECT_EQ(probe_statistics(furnace(8, 0)).dynamic_range_ev(), 0);
}

TEST(ClippedPixels, AreNotWhatIsBlack) {
    EXPECT_EQ(clipped_pixels(ImageF(64, 32, 3)), 0);
}

TEST(ClippedPixels, AreAFlatTop) {
    ImageF image(32, 16, 3, 1.0f);
    EXPECT_EQ(clipped_pixels(image), 0);  // even light is not clipped
    image.at(4, 4, 0) = 50;
    EXPECT_EQ(clipped_pixels(image), 0);  // one brightest pixel is a peak
    for (int x = 4; x < 10; ++x) image.at(x, 4, 0) = 50;
    EXPECT_EQ(clipped_pixels(image), 6);
    for (int x = 8; x < 14; ++x) image.at(x, 4, 2) = 70;  // another channel, two pixels in common
    EXPECT_EQ(clipped_pixels(image), 10);
}

}  // namespace
}  // namespace matchlight
