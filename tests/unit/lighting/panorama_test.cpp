// Panoramas laid onto the sphere: turned, made smaller, with their holes.
#include "lighting/panorama.h"

#include <algorithm>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fisheye_pictures.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Probe rgb_of(const ImageF& four) {
    Probe probe{ImageF(four.width(), four.height(), 3)};
    for (int y = 0; y < four.height(); ++y) {
        for (int x = 0; x < four.width(); ++x) std::copy_n(four.pixel(x, y), 3, probe.latlong.pixel(x, y));
    }
    return probe;
}

const test::Light room = test::striped_room({Vector3d(0.3, 0.8, 0.5).normalized()});

TEST(Panorama, AsItIsKeepsItsPixels) {
    const Probe probe = test::probe_of(64, room);
    const StitchedSphere sphere = panorama_sphere(probe.latlong, {}, Matrix3d::Identity(), 64);
    EXPECT_NEAR(sphere.seen_share, 1, 1e-12);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 128; ++x) {
            for (int c = 0; c < 3; ++c) ASSERT_EQ(sphere.latlong.at(x, y, c), probe.latlong.at(x, y, c));
            ASSERT_EQ(sphere.latlong.at(x, y, 3), 1);
        }
    }
}

TEST(Panorama, TurnedAndSmallerKeepsItsLight) {
    const Probe probe = test::probe_of(512, room);
    const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
    for (const int height : {400, 96}) {
        const StitchedSphere sphere = panorama_sphere(probe.latlong, {}, turn, height);
        EXPECT_NEAR(sphere.seen_share, 1, 1e-12);
        const Probe turned = rgb_of(sphere.latlong);
        std::mt19937 generator(5);
        for (int i = 0; i < 20; ++i) {
            const Vector3d normal = test::random_direction(generator);
            const Vector3d found = irradiance(turned, turn * normal), truth = irradiance(probe, normal);
            // The lattice of points misses a lamp's energy by some tenths of a per cent.
            EXPECT_LT((found - truth).cwiseQuotient(truth).cwiseAbs().maxCoeff(), 0.005) << height;
        }
    }
}

double row_solid_angle(int row, int rows) {
    return (std::cos(std::numbers::pi * row / rows) - std::cos(std::numbers::pi * (row + 1) / rows)) *
           std::numbers::pi / rows;
}

double energy_of(const ImageF& four) {
    double energy = 0;
    for (int y = 0; y < four.height(); ++y) {
        for (int x = 0; x < four.width(); ++x) {
            energy += four.at(x, y, 0) * four.at(x, y, 3) * row_solid_angle(y, four.height());
        }
    }
    return energy;
}

TEST(Panorama, ASmallLampKeepsItsEnergyThroughATurn) {
    const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
    for (const int height : {120, 50}) {
        // One pixel anywhere but at the poles, whose pixels are a hundredth of others and not told apart.
        for (const auto& [x, y] : {std::pair{239, 4}, {17, 15}, {120, 60}, {201, 77}, {0, 110}}) {
            ImageF light(240, 120, 3);
            std::fill_n(light.pixel(x, y), 3, 1e5f);
            const double energy = energy_of(panorama_sphere(light, {}, turn, height).latlong);
            EXPECT_NEAR(energy / (1e5 * row_solid_angle(y, 120)), 1, 0.01) << height << ": " << x << ' ' << y;
        }
        // A sun straight overhead, three rows wide.
        ImageF light(240, 120, 3);
        double truth = 0;
        for (int y = 0; y < 3; ++y) {
            for (float& sample : light.row(y)) sample = 1e5f;
            truth += 240 * 1e5 * row_solid_angle(y, 120);
        }
        EXPECT_NEAR(energy_of(panorama_sphere(light, {}, turn, height).latlong) / truth, 1, 0.02) << height;
    }
}

TEST(Panorama, HolesStayHolesAndAreCounted) {
    Probe probe = test::probe_of(90, room);
    for (int y = 75; y < 90; ++y) {  // a tripod's cap of 30° about straight down
        for (int x = 0; x < 180; ++x) std::fill_n(probe.latlong.pixel(x, y), 3, 0.0f);
    }
    const double cap = (1 - std::cos(30 * std::numbers::pi / 180)) / 2;
    for (const double angle : {0.0, 0.4}) {
        SCOPED_TRACE(angle);
        const Matrix3d turn = Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix();
        const StitchedSphere sphere = panorama_sphere(probe.latlong, {}, turn, 45);
        // Points between a black and a lit pixel count as seen.
        EXPECT_NEAR(sphere.seen_share, 1 - cap, 0.01);
        const Eigen::Vector2d hole = latlong_pixel(turn * -Vector3d::UnitZ(), 90, 45);
        const int y = std::min(44, static_cast<int>(std::lround(hole.y()))),
                  x = static_cast<int>(std::lround(hole.x()));
        for (int c = 0; c < 4; ++c) EXPECT_EQ(sphere.latlong.at(std::clamp(x, 0, 89), y, c), 0);
        // At the hole's rim a pixel is the mean of what was seen of it, not of black.
        const double rim = 30 * std::numbers::pi / 180 + 0.005;
        const Vector3d beside(0, std::sin(rim), -std::cos(rim));
        const Eigen::Vector2d px = latlong_pixel(turn * beside, 90, 45);
        const float* pixel =
            sphere.latlong.pixel(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())));
        EXPECT_NEAR(pixel[1], room(beside).y(), 0.25 * room(beside).y());
    }
}

TEST(Panorama, ClippedPixelsGoWithTheLight) {
    const Probe probe = test::probe_of(64, room);
    ImageF clipped(128, 64, 1);
    const Eigen::Vector2d sun = latlong_pixel(Vector3d::UnitY(), 128, 64);
    for (int y = -4; y <= 4; ++y) {
        for (int x = -4; x <= 4; ++x) {
            clipped.at(static_cast<int>(std::lround(sun.x())) + x, static_cast<int>(std::lround(sun.y())) + y) = 1;
        }
    }
    for (const double angle : {0.0, 0.9}) {
        const Matrix3d turn = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
        const StitchedSphere sphere = panorama_sphere(probe.latlong, clipped, turn, 32);
        const auto at = [&](const Vector3d& direction) {
            const Eigen::Vector2d px = latlong_pixel(turn * direction, 64, 32);
            // Straight back lies on the seam.
            const int x = (static_cast<int>(std::lround(px.x())) + 64) % 64;
            return sphere.clipped.at(x, static_cast<int>(std::lround(px.y())));
        };
        EXPECT_NEAR(at(Vector3d::UnitY()), 1, 1e-3);
        EXPECT_EQ(at(-Vector3d::UnitY()), 0);
        EXPECT_EQ(at(Vector3d::UnitX()), 0);
    }
}

TEST(Panorama, IsTwiceAsWideAsHigh) {
    EXPECT_TRUE(is_panorama_shape(2048, 1024));
    EXPECT_TRUE(is_panorama_shape(2049, 1024));
    EXPECT_FALSE(is_panorama_shape(1024, 1024));
    EXPECT_FALSE(is_panorama_shape(4, 0));
}

}  // namespace
}  // namespace matchlight
