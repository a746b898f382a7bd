// The lat-long frame of INTERFACE, looking up, turning and scaling.
#include "lighting/probe.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "synthetic_probes.h"

namespace matchlight {
namespace {

using test::probe_of;
using test::random_direction;

TEST(Latlong, AxesLieWhereTheInterfaceSays) {
    // 4 × 2: column edges at the axes, so use the edges of pixels.
    EXPECT_TRUE(latlong_direction(-0.5, -0.5, 8, 4).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));  // row 0 is up
    EXPECT_TRUE(latlong_direction(3.5, 1.5, 8, 4).isApprox(Eigen::Vector3d::UnitY(), 1e-12));  // middle looks along +y
    EXPECT_TRUE(latlong_direction(5.5, 1.5, 8, 4).isApprox(Eigen::Vector3d::UnitX(), 1e-12));  // +x on the right of it
    EXPECT_TRUE(latlong_direction(1.5, 1.5, 8, 4).isApprox(-Eigen::Vector3d::UnitX(), 1e-12));
    EXPECT_TRUE(latlong_direction(-0.5, 1.5, 8, 4).isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(Latlong, PixelAndDirectionAreInverse) {
    std::mt19937 generator(1);
    for (int i = 0; i < 10000; ++i) {
        const Eigen::Vector3d direction = random_direction(generator);
        const Eigen::Vector2d pixel = latlong_pixel(direction, 640, 320);
        // Double rounding, amplified by at most the pixel scale.
        EXPECT_NEAR((latlong_direction(pixel.x(), pixel.y(), 640, 320) - direction).norm(), 0, 1e-12);
    }
}

TEST(Probe, RadianceIsBilinearAndWrapsInLongitude) {
    Probe probe{ImageF(4, 2, 3)};
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) probe.latlong.at(x, y, 0) = static_cast<float>(10 * y + x);
    }
    EXPECT_NEAR(probe.radiance(latlong_direction(1, 0, 4, 2))[0], 1, 1e-9);
    EXPECT_NEAR(probe.radiance(latlong_direction(1.25, 0.5, 4, 2))[0], 6.25, 1e-9);
    EXPECT_NEAR(probe.radiance(latlong_direction(3.5, 0, 4, 2))[0], 1.5, 1e-9);  // between 3 and 0 again
    EXPECT_NEAR(probe.radiance(latlong_direction(2, -0.4, 4, 2))[0], 2, 1e-9);   // clamped at the pole
    EXPECT_NEAR(probe.radiance(Eigen::Vector3d::UnitZ())[1], 0, 0);
}

TEST(Placed, TurnsTheLightCounterClockwiseSeenFromAbove) {
    // A lamp at +x, turned by 90° counter-clockwise, stands at +y.
    const auto lamp = [](const Eigen::Vector3d& d) {
        return Eigen::Vector3d::Constant(d.x() > 0.95 ? 10.0 : 1.0).eval();
    };
    const Probe turned = placed(probe_of(64, lamp), {90, 0});
    EXPECT_NEAR(turned.radiance(Eigen::Vector3d::UnitY())[0], 10, 1e-5);
    EXPECT_NEAR(turned.radiance(Eigen::Vector3d::UnitX())[0], 1, 1e-5);
    EXPECT_NEAR(turned.radiance(-Eigen::Vector3d::UnitY())[0], 1, 1e-5);
}

TEST(Placed, MatchesARotationOfTheDirectionAtAnyAngle) {
    const Probe probe = probe_of(128, test::smooth_sky);
    std::mt19937 generator(2);
    for (const double degrees : {-400.0, -33.3, 0.1, 77.7, 359.9}) {
        const Probe turned = placed(probe, {degrees, 0});
        const Eigen::Matrix3d world_from_probe =
            Eigen::AngleAxisd(degrees * M_PI / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        for (int i = 0; i < 100; ++i) {
            const Eigen::Vector3d d = random_direction(generator);
            // Interpolation in a smooth sky of 128 rows: second derivative × (π/128)²/8 ≈ 1e-4; clamped poles 1e-2.
            if (std::abs(d.z()) > 0.99) continue;
            EXPECT_NEAR((turned.radiance(world_from_probe * d) - test::smooth_sky(d)).norm(), 0, 1e-3);
        }
    }
}

TEST(Placed, ScalesByPowersOfTwoAndKeepsEnergy) {
    const Probe probe = probe_of(32, test::smooth_sky);
    const Probe brighter = placed(probe, {12.34, 3});
    const Eigen::Vector3d before = irradiance(probe, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d after = irradiance(brighter, Eigen::Vector3d::UnitZ());
    EXPECT_TRUE(after.isApprox(8 * before, 1e-6));  // rounding of the float image
    // Finite light stays finite at any exposure.
    EXPECT_TRUE(std::isfinite(placed(probe, {0, 500}).latlong.at(3, 3)));
}

TEST(ProbeMapping, NamesGoBothWays) {
    for (const auto mapping :
         {ProbeMapping::latlong, ProbeMapping::angular, ProbeMapping::mirrorball, ProbeMapping::cube}) {
        EXPECT_EQ(probe_mapping_from_name(name_of(mapping)), mapping);
    }
    EXPECT_FALSE(probe_mapping_from_name("fisheye").has_value());
}

}  // namespace
}  // namespace matchlight
