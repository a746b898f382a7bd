// Irradiance against closed forms: furnace, lobes and caps of known light.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "lighting/latlong_grid.h"
#include "lighting/probe.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

constexpr double pi = std::numbers::pi;
using test::furnace;
using test::probe_of;
using test::random_direction;

TEST(LatlongGrid, PixelsCoverTheSphere) {
    for (const int height : {1, 2, 7, 64, 513}) {
        const LatlongGrid grid(2 * height, height);
        double sum = 0;
        double upper = 0;
        for (int y = 0; y < height; ++y) {
            sum += grid.solid_angle(y) * grid.width();
            upper += grid.row_above(y, 0.25).sin1 * grid.azimuth_step() * grid.width();
        }
        EXPECT_NEAR(sum, 4 * pi, 1e-12);
        EXPECT_NEAR(upper, 2 * pi * 0.75, 1e-8);  // slivers under 1e-9 of a row are left out
    }
}

TEST(Irradiance, WhiteFurnaceIsPi) {
    const Probe probe = furnace(64, 1);
    std::mt19937 generator(3);
    for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d n = random_direction(generator);
        // Pixels cut by the horizon count by their mean cosine: a relative error of the order of (pixel size)², 6e-4.
        EXPECT_NEAR(irradiance(probe, n)[1], pi, 6e-4 * pi);
    }
    EXPECT_NEAR(irradiance(probe, Eigen::Vector3d::UnitZ())[0], pi, 1e-9);  // no pixel is cut
}

TEST(Irradiance, CapOfLight) {
    // A cap of half-angle a around z: E(z) = π sin² a. 512 rows hold the cap's edge exactly at row 64 (22.5°).
    const double a = pi / 8;
    const Probe probe = probe_of(512, [&](const Eigen::Vector3d& d) {
        return Eigen::Vector3d::Constant(d.z() > std::cos(a) ? 2.0 : 0.0).eval();
    });
    const double expected = 2 * pi * std::sin(a) * std::sin(a);
    EXPECT_NEAR(irradiance(probe, Eigen::Vector3d::UnitZ())[2], expected, 1e-9 * expected);
    const Eigen::Vector3d tilted(std::sin(1.0), 0, std::cos(1.0));  // the whole cap above its horizon: a cosine
    EXPECT_NEAR(irradiance(probe, tilted)[2], expected * std::cos(1.0), 1e-9 * expected);
    EXPECT_NEAR(irradiance(probe, -Eigen::Vector3d::UnitZ())[2], 0, 1e-12);
}

TEST(Irradiance, LinearSky) {
    // L = 1 + d·g has E(n) = π + (2π/3) n·g (first-order coefficient of the clamped cosine).
    const Eigen::Vector3d g(0.3, -0.5, 0.4);
    const Probe probe =
        probe_of(256, [&](const Eigen::Vector3d& d) { return Eigen::Vector3d::Constant(1 + g.dot(d)).eval(); });
    std::mt19937 generator(4);
    for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d n = random_direction(generator);
        const double expected = pi + 2 * pi / 3 * n.dot(g);
        EXPECT_NEAR(irradiance(probe, n)[0], expected, 1e-4 * expected);  // (π/256)² of piecewise constancy
    }
}

TEST(SphericalHarmonics, FurnaceHasOnlyTheConstant) {
    const auto sh = project_to_sh(furnace(16, 1));
    EXPECT_NEAR(sh[0][0], std::sqrt(4 * pi), 1e-12);
    for (std::size_t i = 1; i < 9; ++i) EXPECT_NEAR(sh[i].norm(), 0, 1e-12);
}

TEST(SphericalHarmonics, AreOrthonormalAndInTheStatedOrder) {
    // Projecting each basis function gives its own coefficient, 1, and no other.
    const std::array<std::function<double(const Eigen::Vector3d&)>, 9> basis = {
        [](const Eigen::Vector3d&) { return 0.282094792; },
        [](const Eigen::Vector3d& d) { return 0.488602512 * d.y(); },
        [](const Eigen::Vector3d& d) { return 0.488602512 * d.z(); },
        [](const Eigen::Vector3d& d) { return 0.488602512 * d.x(); },
        [](const Eigen::Vector3d& d) { return 1.092548431 * d.x() * d.y(); },
        [](const Eigen::Vector3d& d) { return 1.092548431 * d.y() * d.z(); },
        [](const Eigen::Vector3d& d) { return 0.315391565 * (3 * d.z() * d.z() - 1); },
        [](const Eigen::Vector3d& d) { return 1.092548431 * d.x() * d.z(); },
        [](const Eigen::Vector3d& d) { return 0.546274215 * (d.x() * d.x() - d.y() * d.y()); },
    };
    for (std::size_t i = 0; i < basis.size(); ++i) {
        const Probe probe =
            probe_of(128, [&](const Eigen::Vector3d& d) { return Eigen::Vector3d::Constant(basis[i](d)).eval(); });
        const auto sh = project_to_sh(probe);
        for (std::size_t j = 0; j < basis.size(); ++j) {
            EXPECT_NEAR(sh[j][1], i == j ? 1.0 : 0.0, 1e-3) << i << " " << j;  // (π/128)² of piecewise constancy
        }
    }
}

TEST(SphericalHarmonics, GiveTheIrradianceOfAQuadraticSkyExactly) {
    // Such a sky has no order above 2, so nothing is lost; what remains is piecewise constancy.
    const Probe probe = probe_of(256, test::smooth_sky);
    const auto sh = project_to_sh(probe);
    std::mt19937 generator(5);
    for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d n = random_direction(generator);
        EXPECT_NEAR((irradiance_from_sh(sh, n) - irradiance(probe, n)).norm(), 0, 1e-3);
    }
}

TEST(SphericalHarmonics, StayWithinATenthForALamp) {
    // Ramamoorthi & Hanrahan: 9 coefficients hold irradiance to about 1 % on average, 3 % at one pixel of natural
    // light; a single lamp is the worst case, whose largest error is 9 % of its largest irradiance.
    const Probe probe = probe_of(256, [](const Eigen::Vector3d& d) {
        return Eigen::Vector3d::Constant(d.dot(Eigen::Vector3d(0.6, 0, 0.8)) > 0.99 ? 100.0 : 0.0).eval();
    });
    const auto sh = project_to_sh(probe);
    const double largest = irradiance(probe, {0.6, 0, 0.8})[0];
    std::mt19937 generator(6);
    for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d n = random_direction(generator);
        EXPECT_LE(std::abs(irradiance_from_sh(sh, n)[0] - irradiance(probe, n)[0]), 0.1 * largest);
    }
}

}  // namespace
}  // namespace matchlight
