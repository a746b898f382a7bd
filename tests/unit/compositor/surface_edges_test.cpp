// The end of what is known of the real surface: no step, and no holes of a few texels.
#include "compositor/surface_edges.h"

#include <cmath>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

GatheredSurface grey_surface(int size) {
    return {ImageF(size, size, 4, 1.0f), ImageF(size, size, 1), {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)}};
}

TEST(SurfaceEdges, small_holes_take_their_neighbours_light) {
    GatheredSurface gathered = grey_surface(32);
    for (int y = 14; y < 17; ++y) {
        for (int x = 14; x < 17; ++x) std::fill_n(gathered.radiance.pixel(x, y), 4, 0.0f);
    }
    close_holes(gathered);
    for (const float value : gathered.radiance.samples()) EXPECT_EQ(value, 1.0f);
}

TEST(SurfaceEdges, wide_holes_stay) {
    GatheredSurface gathered = grey_surface(64);
    for (int y = 16; y < 48; ++y) {
        for (int x = 16; x < 48; ++x) std::fill_n(gathered.radiance.pixel(x, y), 4, 0.0f);
    }
    close_holes(gathered);
    EXPECT_EQ(gathered.radiance.at(32, 32, 3), 0.0f);
    EXPECT_EQ(gathered.radiance.at(20, 32, 3), 0.0f);
}

TEST(SurfaceEdges, knowledge_falls_without_a_step) {
    GatheredSurface gathered = grey_surface(128);
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 64; ++x) gathered.radiance.at(x, y, 3) = 0.0f;
    }
    soften_edges(gathered);
    EXPECT_EQ(gathered.radiance.at(63, 64, 3), 0.0f);
    EXPECT_EQ(gathered.radiance.at(96, 64, 3), 1.0f);
    // The steepest step of a smooth curve over 16 texels is 1.5 / 16.
    for (int x = 1; x < 128; ++x)
        EXPECT_LT(std::abs(gathered.radiance.at(x, 64, 3) - gathered.radiance.at(x - 1, 64, 3)), 0.1f) << x;
    EXPECT_LT(gathered.radiance.at(127, 64, 3), 0.02f);  // the border
}

TEST(SurfaceEdges, rounding_keeps_what_halves_hold) {
    ImageF image(3, 1, 1);
    image.at(0, 0) = 0.1f;
    image.at(1, 0) = 1e6f;
    image.at(2, 0) = 0.25f;
    round_to_half(image);
    EXPECT_NEAR(image.at(0, 0), 0.1f, 3e-5f);
    EXPECT_NE(image.at(0, 0), 0.1f);
    EXPECT_EQ(image.at(1, 0), 65504.0f);
    EXPECT_EQ(image.at(2, 0), 0.25f);
}

}  // namespace
}  // namespace matchlight
