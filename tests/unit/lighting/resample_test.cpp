// Resampling keeps uniform light uniform, lamps at their energy, and pictures upright.
#include "lighting/resample.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "lighting/mappings.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using test::furnace;
using test::probe_of;
using test::random_direction;

std::vector<ProbeLayout> layouts_of(int latlong_height) {
    std::vector<ProbeLayout> layouts;
    for (const auto mapping : {ProbeMapping::angular, ProbeMapping::mirrorball, ProbeMapping::cube}) {
        layouts.push_back(layout_of_size(mapping, size_for_latlong(mapping, latlong_height)));
    }
    return layouts;
}

TEST(Resample, UniformLightStaysUniform) {
    for (const ProbeLayout& layout : layouts_of(64)) {
        const Probe back = probe_from_image(image_from_probe(furnace(64, 3), layout), layout, 64);
        for (const float sample : back.latlong.samples()) EXPECT_NEAR(sample, 3, 1e-5);  // float rounding
    }
}

TEST(Resample, ThereAndBackKeepsIrradianceWithinATenthOfAPercent) {
    // Walls and a sun of 10⁵ times their radiance in a single pixel: its energy must not hang on how the lattice of
    // points meets its pixel.
    std::mt19937 generator(10);
    for (int i = 0; i < 4; ++i) {
        Probe probe = probe_of(128, test::smooth_sky);
        const Vector3d sun = random_direction(generator);
        const Eigen::Vector2i at = nearest_pixel(layout_of_size(ProbeMapping::latlong, 128), sun);
        for (int c = 0; c < 3; ++c) probe.latlong.at(at.x(), at.y(), c) = 1e5f;
        for (const auto cube :
             {CubeLayout::vertical_cross, CubeLayout::horizontal_cross, CubeLayout::strip, CubeLayout::column}) {
            const ProbeLayout layout = layout_of_size(ProbeMapping::cube, 64, cube);
            const Probe back = probe_from_image(image_from_probe(probe, layout), layout, 128);
            const Vector3d before = irradiance(probe, sun);
            EXPECT_NEAR((irradiance(back, sun) - before).norm(), 0, 1e-3 * before.norm());
        }
    }
}

TEST(Resample, EveryMappingKeepsALampsEnergy) {
    std::mt19937 generator(11);
    for (int i = 0; i < 6; ++i) {
        Probe probe = furnace(96, 0);
        const Vector3d lamp = random_direction(generator);
        const Eigen::Vector2i at = nearest_pixel(layout_of_size(ProbeMapping::latlong, 96), lamp);
        probe.latlong.at(at.x(), at.y(), 1) = 1e4f;
        const double before = project_to_sh(probe)[0][1];  // ∝ total energy
        for (const ProbeLayout& layout : layouts_of(96)) {
            const Probe back = probe_from_image(image_from_probe(probe, layout), layout, 96);
            // 3e-4 is what the balance leaves (resample.cpp). The outermost ring of a mirror ball's pixels, which the
            // disc's edge cuts, shows what lies less than 25° from straight behind, and is good to 3 %.
            const bool rim = layout.mapping == ProbeMapping::mirrorball && lamp.y() < -0.9;
            EXPECT_NEAR(project_to_sh(back)[0][1], before, (rim ? 0.03 : 1e-3) * before) << name_of(layout.mapping);
        }
    }
}

TEST(Resample, ShrinkingAndEnlargingKeepTheMean) {
    const Probe probe = probe_of(128, [](const Vector3d& d) {
        return Vector3d::Constant(d.dot(Vector3d(0.6, 0.64, 0.48)) > 0.995 ? 1000.0 : 1.0).eval();
    });
    const double before = project_to_sh(probe)[0][0];
    const ProbeLayout full = layout_of_size(ProbeMapping::latlong, 128);
    for (const int height : {8, 37, 64, 300}) {
        const Probe other = probe_from_image(probe.latlong, full, height);
        EXPECT_EQ(other.latlong.height(), height);
        EXPECT_NEAR(project_to_sh(other)[0][0], before, 2e-3 * before) << height;
    }
}

TEST(Resample, PicturesStayUprightAndUnmirrored) {
    // Each axis has its own colour; it must be found in the same direction after every journey.
    const auto marked = [](const Vector3d& d) {
        return Vector3d(0.2 + (d.x() > 0.9), 0.2 + (d.y() > 0.9), 0.2 + (d.z() > 0.9));
    };
    const Probe probe = probe_of(128, marked);
    for (const ProbeLayout& layout : layouts_of(128)) {
        const Probe back = probe_from_image(image_from_probe(probe, layout), layout, 128);
        for (int axis = 0; axis < 3; ++axis) {
            Vector3d expected = Vector3d::Constant(0.2);
            EXPECT_NEAR((back.radiance(-Vector3d::Unit(axis)) - expected).norm(), 0, 1e-4);
            expected[axis] += 1;
            EXPECT_NEAR((back.radiance(Vector3d::Unit(axis)) - expected).norm(), 0, 1e-4);
        }
    }
}

TEST(Resample, SmoothLightComesBackWithinOnePercent) {
    for (const ProbeLayout& layout : layouts_of(128)) {
        const Probe probe = probe_of(128, test::smooth_sky);
        const Probe back = probe_from_image(image_from_probe(probe, layout), layout, 128);
        std::mt19937 generator(12);
        for (int i = 0; i < 300; ++i) {
            const Vector3d d = random_direction(generator);
            if (layout.mapping == ProbeMapping::mirrorball && d.y() < -0.98) continue;  // the rim is one pixel wide
            EXPECT_NEAR((back.radiance(d) - test::smooth_sky(d)).norm(), 0, 0.02) << name_of(layout.mapping);
        }
    }
}

TEST(Resample, TheMirrorBallIsTheClassicSphereMap) {
    // m = 2·sqrt(rx² + ry² + (rz + 1)²), texture coordinates (rx/m + ½, ry/m + ½) from the lower left, where the map's
    // axis z is world forward, +y, and its y world up.
    const int size = 256;
    const ImageF image =
        image_from_probe(probe_of(256, test::smooth_sky), layout_of_size(ProbeMapping::mirrorball, size));
    std::mt19937 generator(13);
    for (int i = 0; i < 300; ++i) {
        const Vector3d r = random_direction(generator);
        if (r.y() < -0.95) continue;
        const double m = 2 * std::sqrt(r.x() * r.x() + r.z() * r.z() + (r.y() + 1) * (r.y() + 1));
        const int x = std::min(size - 1, static_cast<int>((r.x() / m + 0.5) * size));
        const int y = std::min(size - 1, static_cast<int>((1 - (r.z() / m + 0.5)) * size));
        // Half a pixel of 256: 0.5/64 rad in the middle, more towards the rim, times a slope of about 1.
        EXPECT_NEAR(image.at(x, y, 0), test::smooth_sky(r)[0], 0.04);
    }
}

}  // namespace
}  // namespace matchlight
