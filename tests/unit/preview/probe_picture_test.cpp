// The probe looked at: where its light stands, and what balls make of it.
#include "preview/probe_picture.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

/// Grey light from everywhere, and red light from the right (+x of the world).
Probe light_from_the_right() {
    Probe probe{ImageF(64, 32, 3)};
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c) probe.latlong.at(x, y, c) = 0.1f;
            if (latlong_direction(x, y, 64, 32).x() > 0.9) probe.latlong.at(x, y, 0) = 0.8f;
        }
    }
    return probe;
}

TEST(ProbePicture, LatLongKeepsItsShape) {
    const Image8 picture = probe_picture(light_from_the_right(), {.width = 120, .height = 90});
    EXPECT_EQ(picture.at(60, 14, 1), 0) << "bars above";
    // Middle column +y; +x a quarter to the right of it.
    EXPECT_EQ(picture.at(90, 45, 0), std::lround(255 * (1.055 * std::pow(0.8, 1 / 2.4) - 0.055)));
    EXPECT_LT(picture.at(30, 45, 0), 100);
    // A stop more is twice the light.
    const Image8 brighter = probe_picture(light_from_the_right(), {.width = 120, .height = 90, .exposure_ev = 1});
    EXPECT_EQ(brighter.at(30, 45, 1), std::lround(255 * (1.055 * std::pow(0.2, 1 / 2.4) - 0.055)));
}

TEST(ProbePicture, BallsShowTheLightFromItsSide) {
    // Seen along +y with +x to the right, as cameras see.
    Eigen::Matrix3d world_from_camera;
    world_from_camera.col(0) = Eigen::Vector3d::UnitX();
    world_from_camera.col(1) = -Eigen::Vector3d::UnitZ();
    world_from_camera.col(2) = Eigen::Vector3d::UnitY();
    const Image8 picture =
        probe_picture(light_from_the_right(),
                      {.form = ProbeForm::balls, .width = 300, .height = 100, .world_from_camera = world_from_camera});
    EXPECT_EQ(picture.at(1, 1, 0), 0) << "beside the balls";
    for (const int middle : {50, 150, 250}) {
        const int offset = middle == 250 ? 40 : 32;  // a mirror shows +x where its normal is half-way there
        EXPECT_GT(picture.at(middle + offset, 50, 0), picture.at(middle - offset, 50, 0) + 20) << middle;
        EXPECT_NEAR(picture.at(middle + offset, 50, 1), picture.at(middle - offset, 50, 1), 2) << middle;
    }
}

TEST(ProbePicture, OfEvenLightAllBallsAreAsBright) {
    Probe even{ImageF(32, 16, 3)};
    for (float& sample : even.latlong.samples()) sample = 0.5f;
    const Image8 picture = probe_picture(even, {.form = ProbeForm::balls, .width = 90, .height = 30});
    // The furnace: whatever a white ball is made of. A code of rounding.
    for (const int middle : {15, 45, 75}) {
        EXPECT_NEAR(picture.at(middle, 15, 1), std::lround(255 * (1.055 * std::pow(0.5, 1 / 2.4) - 0.055)), 1);
    }
}

}  // namespace
}  // namespace matchlight
