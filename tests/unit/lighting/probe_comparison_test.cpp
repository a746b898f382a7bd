// Probes held against others that are known to differ from them, and by how much.
#include "lighting/probe_comparison.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "synthetic_probes.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using test::probe_of;

/// Walls with a gradient and a lamp of 4° around `axis`.
Probe lit_room(const Vector3d& axis, double lamp) {
    const Vector3d unit = axis.normalized();
    return probe_of(128, [=](const Vector3d& d) {
        Vector3d radiance = test::smooth_sky(d);
        if (d.dot(unit) > std::cos(4 * std::numbers::pi / 180)) radiance += Vector3d::Constant(lamp);
        return radiance;
    });
}

const Vector3d towards_lamp(0.3, 0.8, 0.52);

TEST(ProbeComparison, AProbeIsAsItself) {
    const Probe probe = lit_room(towards_lamp, 500);
    const ProbeComparison same = compare_probes(probe, probe);
    EXPECT_NEAR((same.gain - Vector3d::Ones()).norm(), 0, 1e-12);
    EXPECT_NEAR(same.irradiance_rmse, 0, 1e-9);
    EXPECT_NEAR(same.brightest_angle_deg, 0, 1e-6);
    EXPECT_NEAR(same.median_abs_ev, 0, 1e-9);
    EXPECT_EQ(same.black_share, 0);
    EXPECT_NEAR(same.ball_rms_ev, 0, 1e-9);
    ASSERT_EQ(same.lights.size(), 1u);
    EXPECT_NEAR(same.lights[0].power_ev, 0, 1e-9);
}

TEST(ProbeComparison, GainIsFreeOnlyAsAsked) {
    const Probe truth = lit_room(towards_lamp, 500);
    Probe test = truth;
    const Vector3d tint(4, 2, 1);
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            for (int c = 0; c < 3; ++c) test.latlong.at(x, y, c) *= static_cast<float>(tint[c]);
        }
    }
    const ProbeComparison free = compare_probes(truth, test);
    EXPECT_NEAR((free.gain.cwiseProduct(tint) - Vector3d::Ones()).norm(), 0, 1e-6);
    EXPECT_NEAR(free.irradiance_rmse, 0, 1e-6);
    EXPECT_NEAR(free.ball_median_abs_ev, 0, 1e-5);
    EXPECT_GT(compare_probes(truth, test, {.free_gain = FreeGain::common}).irradiance_rmse, 0.2);
    const ProbeComparison none = compare_probes(truth, test, {.free_gain = FreeGain::none});
    EXPECT_EQ(none.gain, Vector3d::Ones());
    EXPECT_GT(none.mean_ev, 0.9);
}

TEST(ProbeComparison, ALampAstrayAndADimOneAreMeasured) {
    // The lamp turned by 1° about the vertical, and half of it missing.
    const double turn = std::numbers::pi / 180;
    const Vector3d turned(towards_lamp.x() * std::cos(turn) - towards_lamp.y() * std::sin(turn),
                          towards_lamp.x() * std::sin(turn) + towards_lamp.y() * std::cos(turn), towards_lamp.z());
    const double angle = std::acos(towards_lamp.normalized().dot(turned.normalized())) * 180 / std::numbers::pi;
    const ProbeComparison result =
        compare_probes(lit_room(towards_lamp, 500), lit_room(turned, 250), {.free_gain = FreeGain::none});
    ASSERT_EQ(result.lights.size(), 1u);
    // A disc of 4° drawn in pixels of 1.4°: its edge is rough.
    EXPECT_NEAR(result.lights[0].angle_deg, angle, 0.15);
    EXPECT_NEAR(result.lights[0].power_ev, -1, 0.08);
    EXPECT_NEAR(result.brightest_angle_deg, angle, 0.15);
    EXPECT_GT(result.irradiance_rmse, 0.1);
    EXPECT_NEAR(result.median_abs_ev, 0, 1e-6);  // the walls are the same
}

TEST(ProbeComparison, SizesMayDifferAndBlackIsCounted) {
    const Probe truth = lit_room(towards_lamp, 50);
    Probe test = probe_of(64, [](const Vector3d& d) {
        if (d.z() < -0.5) return Vector3d::Zero().eval();
        return test::smooth_sky(d).eval();
    });
    const ProbeComparison result = compare_probes(truth, test, {.free_gain = FreeGain::none});
    EXPECT_NEAR(result.black_share, 0.25, 0.01);  // a cap of z < −½ is a quarter of the sphere
    EXPECT_LT(result.median_abs_ev, 0.01);
}

TEST(ProbeComparison, EvenDirectionsIntegrateTheSphere) {
    Vector3d mean = Vector3d::Zero();
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    const auto directions = even_directions(400);
    for (const Vector3d& d : directions) {
        EXPECT_NEAR(d.norm(), 1, 1e-12);
        mean += d / 400;
        square += d * d.transpose() / 400;
    }
    EXPECT_NEAR(mean.norm(), 0, 1e-3);
    EXPECT_NEAR((square - Eigen::Matrix3d::Identity() / 3).norm(), 0, 1e-3);
}

}  // namespace
}  // namespace matchlight
