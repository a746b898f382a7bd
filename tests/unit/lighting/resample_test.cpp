// Resampling keeps uniform light uniform, lamps at their energy, and pictures upright.
#include "lighting/resample.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "lighting/latlong_grid.h"
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

Probe channel(const Probe& probe, int c) {
    Probe grey = probe;
    for (int y = 0; y < grey.latlong.height(); ++y) {
        for (int x = 0; x < grey.latlong.width(); ++x) {
            for (int other = 0; other < 3; ++other) grey.latlong.at(x, y, other) = probe.latlong.at(x, y, c);
        }
    }
    return grey;
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

struct LampFlux {
    double power = 0;
    Vector3d direction = Vector3d::Zero();
};

/// Of all the light there is.
LampFlux flux_of(const Probe& probe) {
    const LatlongGrid grid(probe.latlong.width(), probe.latlong.height());
    LampFlux flux;
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            const double radiance = probe.latlong.at(x, y, 1);
            flux.power += radiance * grid.solid_angle(y);
            flux.direction +=
                radiance * Vector3d(grid.row(y).sin2 * grid.column(x).sine, grid.row(y).sin2 * grid.column(x).cosine,
                                    grid.row(y).sin1_cos1 * grid.azimuth_step());
        }
    }
    flux.direction.normalize();
    return flux;
}

double angle_between(const Vector3d& a, const Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(Resample, EveryMappingKeepsALampsEnergyAndDirectionWhereverItStands) {
    constexpr int height = 64;
    const ProbeLayout latlong = layout_of_size(ProbeMapping::latlong, height);
    std::vector<Vector3d> places = {{0.001, 0.001, 1}, {0.001, 0.001, -1},  // the poles of a lat-long map
                                    {0.001, -1, 0.01},                      // its seam, and straight behind: the rim
                                    {-0.001, -1, 0.8}, {1, 1, 0.3},         // the seam; an edge of the cube
                                    {1, 1, 1},         {-1, -1, -1},        // its corners
                                    {0.05, -1, 0.05},  {0.3, -1, 0.2},      // near the rim of a disc
                                    {0.01, 1, 0.01}};                       // its middle
    std::mt19937 generator(11);
    for (int i = 0; i < 3; ++i) places.push_back(random_direction(generator));
    std::vector<ProbeLayout> layouts = layouts_of(height);
    for (const ProbeLayout& half : layouts_of(height / 2)) layouts.push_back(half);
    layouts.push_back(layout_of_size(ProbeMapping::latlong, height / 2));
    layouts.push_back(layout_of_size(ProbeMapping::latlong, height * 3 / 2));
    for (const ProbeLayout& layout : layouts) {
        // All lamps in one journey each would take minutes; as channels of one picture they share the work.
        for (std::size_t first = 0; first < places.size(); first += 3) {
            Probe probe = furnace(height, 0);
            const auto count = static_cast<int>(std::min<std::size_t>(3, places.size() - first));
            for (int c = 0; c < count; ++c) {
                const Eigen::Vector2i at = nearest_pixel(latlong, places[first + static_cast<std::size_t>(c)]);
                probe.latlong.at(at.x(), at.y(), c) = 1e6f;
            }
            const Probe back = probe_from_image(image_from_probe(probe, layout), layout, height);
            for (int c = 0; c < count; ++c) {
                const LampFlux before = flux_of(channel(probe, c));
                const LampFlux after = flux_of(channel(back, c));
                // What the balance may leave (ResampleOptions), twice.
                EXPECT_NEAR(after.power, before.power, 5e-4 * before.power)
                    << name_of(layout.mapping) << " at " << before.direction.transpose();
                EXPECT_LE(angle_between(after.direction, before.direction),
                          reach_of_pixel(layout, before.direction) + std::numbers::pi / height)
                    << name_of(layout.mapping) << " at " << before.direction.transpose();
            }
        }
    }
}

TEST(Resample, MoreWorkLeavesLessOfALampsEnergyAstray) {
    const ProbeLayout cube = layout_of_size(ProbeMapping::cube, 32);
    const ProbeLayout latlong = layout_of_size(ProbeMapping::latlong, 64);
    Probe probe = probe_of(64, test::smooth_sky);
    for (int c = 0; c < 3; ++c) probe.latlong.at(70, 0, c) = 1e6f;  // at the pole
    const double before = flux_of(probe).power;
    const auto error = [&](int passes) {
        const ImageF there = resample(probe.latlong, latlong, cube, {.most_passes = passes});
        return std::abs(flux_of({resample(there, cube, latlong, {.most_passes = passes})}).power / before - 1);
    };
    EXPECT_GT(error(4), 2e-3);
    EXPECT_LT(error(48), 5e-4);
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
