// Directions to the corners of a divided octahedron, and the light that each stands for.
#include "lighting/octahedral_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(OctahedralDirections, AreAsManyAsTheirFormulaSaysAndCoverTheSphere) {
    for (int divisions = 0; divisions <= most_octahedral_divisions; ++divisions) {
        const auto directions = octahedral_directions(divisions);
        const auto count = static_cast<std::size_t>(2 + std::lround(std::pow(4, divisions + 1)));
        ASSERT_EQ(directions.size(), count);
        EXPECT_EQ(count, static_cast<std::size_t>(octahedral_counts.at(static_cast<std::size_t>(divisions))));
        double nearest = 0;
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_NEAR(directions[i].norm(), 1, 1e-15);
            // To the last bit: opposite directions share a map.
            if (i % 2 == 1) {
                EXPECT_EQ(directions[i], -directions[i - 1]);
            }
            for (std::size_t j = 0; j < i; ++j) nearest = std::max(nearest, directions[i].dot(directions[j]));
        }
        // The corners next to the octahedron's own stand closest: halves of 90°, again and again.
        const double step = std::numbers::pi / 2 / (1 << divisions);
        EXPECT_NEAR(std::acos(nearest), step, 1e-9) << divisions;
    }
}

TEST(OctahedralDirections, ShareAllOfAProbesLightAmongThem) {
    // Fewer pixels than directions: each of them still has its part.
    Probe coarse{ImageF(16, 8, 3, 0.5F)};
    Probe fine{ImageF(256, 128, 3)};
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            fine.latlong.at(x, y, 0) = static_cast<float>(1 + latlong_direction(x, y, 256, 128).z());
            fine.latlong.at(x, y, 1) = 2;
        }
    }
    for (const int divisions : {0, 2, 4}) {
        Eigen::Vector3d light = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
        for (const DirectionalSample& sample : sample_octahedrally(fine, divisions)) {
            light += sample.radiance_times_solid_angle;
            moment += sample.radiance_times_solid_angle[0] * sample.direction;
        }
        EXPECT_NEAR(light[0], 4 * std::numbers::pi, 1e-4);
        EXPECT_NEAR(light[1], 8 * std::numbers::pi, 1e-4);
        EXPECT_EQ(light[2], 0);
        // ∫ z (1 + z) dω = 4π/3, less what directions of a width keep of their own mean.
        if (divisions == most_octahedral_divisions) {
            EXPECT_NEAR(moment[2], 4 * std::numbers::pi / 3, 0.01);
        }
        double least = 1e9, most = 0;
        for (const DirectionalSample& sample : sample_octahedrally(coarse, divisions)) {
            least = std::min(least, sample.radiance_times_solid_angle[0]);
            most = std::max(most, sample.radiance_times_solid_angle[0]);
            EXPECT_NEAR(sample.radiance_times_solid_angle[0], 0.5 * sample.solid_angle_sr, 1e-12);
        }
        EXPECT_GT(least, 0.2 * most) << divisions;
    }
}

}  // namespace
}  // namespace matchlight
