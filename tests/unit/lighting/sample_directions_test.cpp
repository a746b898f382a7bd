// Directional samples carry all the light of their domain and light a plane as the probe does.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "lighting/latlong_grid.h"
#include "lighting/probe.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

using test::probe_of;

Eigen::Vector3d sky_with_sun(const Eigen::Vector3d& d) {
    const bool sun = d.dot(Eigen::Vector3d(0.48, 0.6, 0.64)) > 0.9995;
    return test::smooth_sky(d) + (sun ? Eigen::Vector3d(3000, 2500, 2000) : Eigen::Vector3d(0, 0, 0));
}

Eigen::Vector3d integral_above(const Probe& probe, double minimum_z) {
    const LatlongGrid grid(probe.latlong.width(), probe.latlong.height());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = 0; y < grid.height(); ++y) {
        const double solid_angle = grid.row_above(y, minimum_z).sin1 * grid.azimuth_step();
        for (int x = 0; x < grid.width(); ++x) {
            const float* p = probe.latlong.pixel(x, y);
            sum += solid_angle * Eigen::Vector3d(p[0], p[1], p[2]);
        }
    }
    return sum;
}

TEST(SampleDirections, CarryTheWholeIntegral) {
    const Probe probe = probe_of(100, sky_with_sun);
    for (const double minimum_z : {-1.0, 0.0, 0.123}) {
        for (const int count : {1, 7, 64, 500}) {
            for (const bool cosine : {false, true}) {
                const auto samples = sample_directions(probe, count, minimum_z, cosine);
                ASSERT_EQ(samples.size(), static_cast<std::size_t>(count));
                Eigen::Vector3d sum = Eigen::Vector3d::Zero();
                for (const auto& s : samples) {
                    sum += s.radiance_times_solid_angle;
                    EXPECT_NEAR(s.direction.norm(), 1, 1e-12);
                    EXPECT_TRUE(minimum_z < 0 || s.direction.z() >= minimum_z - 1e-9);
                }
                const Eigen::Vector3d expected = integral_above(probe, minimum_z);
                EXPECT_NEAR((sum - expected).norm(), 0, 1e-9 * expected.norm());
            }
        }
    }
}

TEST(SampleDirections, LightALevelPlaneAsTheProbeDoes) {
    const Probe probe = probe_of(128, sky_with_sun);
    const Eigen::Vector3d exact = irradiance(probe, Eigen::Vector3d::UnitZ());
    for (const bool cosine : {false, true}) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto& s : sample_directions(probe, 64, 0, cosine)) {
            sum += s.radiance_times_solid_angle * std::max(0.0, s.direction.z());
        }
        EXPECT_NEAR((sum - exact).norm(), 0, 0.01 * exact.norm()) << cosine;
    }
}

TEST(SampleDirections, LightATiltedPlaneToo) {
    const Probe probe = probe_of(128, sky_with_sun);
    const Eigen::Vector3d n = Eigen::Vector3d(0.5, -0.5, 0.7).normalized();
    const Eigen::Vector3d exact = irradiance(probe, n);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& s : sample_directions(probe, 256, -1, false)) {
        sum += s.radiance_times_solid_angle * std::max(0.0, n.dot(s.direction));
    }
    EXPECT_NEAR((sum - exact).norm(), 0, 0.01 * exact.norm());
}

TEST(SampleDirections, ASmallSunTakesFewStrataHoweverStrong) {
    // Half a degree across and three quarters of the light: its shadow's edge is sharp with one direction already.
    const Eigen::Vector3d towards_sun(0.48, 0.6, 0.64);
    const Probe probe = probe_of(512, [&](const Eigen::Vector3d& d) -> Eigen::Vector3d {
        const double sun = d.dot(towards_sun) > std::cos(0.25 * std::numbers::pi / 180) ? 5e4 : 0.0;
        return Eigen::Vector3d::Constant(0.3 + sun);
    });
    int on_sun = 0;
    for (const auto& s : sample_directions(probe, 64, 0, true)) on_sun += s.direction.dot(towards_sun) > std::cos(0.01);
    EXPECT_GE(on_sun, 1);
    EXPECT_LE(on_sun, 16);
}

TEST(SampleDirections, ASunIsFoundWhereItStands) {
    const Probe probe = probe_of(256, sky_with_sun);
    const auto samples = sample_directions(probe, 16, 0, true);
    const auto strongest = std::max_element(samples.begin(), samples.end(), [](const auto& a, const auto& b) {
        return a.radiance_times_solid_angle.sum() < b.radiance_times_solid_angle.sum();
    });
    EXPECT_GT(strongest->direction.dot(Eigen::Vector3d(0.48, 0.6, 0.64)), std::cos(0.03));
}

TEST(SampleDirections, FewLitPixelsGiveFewSamples) {
    Probe probe{ImageF(16, 8, 3)};
    EXPECT_TRUE(sample_directions(probe, 8, 0, true).empty());
    probe.latlong.at(3, 1, 0) = 5;
    probe.latlong.at(9, 2, 1) = 5;
    EXPECT_EQ(sample_directions(probe, 8, 0, true).size(), 2u);
    EXPECT_TRUE(sample_directions(probe, 0, 0, true).empty());
}

TEST(SampleDirections, AreTheSameEveryTime) {
    const Probe probe = probe_of(64, sky_with_sun);
    const auto first = sample_directions(probe, 50, 0, true);
    const auto second = sample_directions(probe, 50, 0, true);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        EXPECT_EQ(first[i].direction, second[i].direction);
        EXPECT_EQ(first[i].radiance_times_solid_angle, second[i].radiance_times_solid_angle);
    }
}

}  // namespace
}  // namespace matchlight
