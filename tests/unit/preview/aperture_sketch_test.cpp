// The picture of an opening that was drawn by hand.
#include "preview/aperture_sketch.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Eigen::Vector2d;

double share_of_white(const Image8& picture) {
    double sum = 0;
    for (const std::uint8_t code : picture.samples()) sum += code;
    return sum / 255 / static_cast<double>(picture.samples().size());
}

TEST(ApertureSketch, IsWhiteInsideItsCorners) {
    const std::vector<Vector2d> triangle{{0.1, 0.1}, {0.9, 0.12}, {0.13, 0.9}};
    const Image8 picture = picture_of_polygon(triangle, 64);
    EXPECT_EQ(picture.at(16, 16, 0), 255);
    EXPECT_EQ(picture.at(60, 60, 1), 0);
    EXPECT_EQ(picture.at(2, 32, 2), 0);
    // Half of 0.8 · 0.8 − 0.02 · 0.03. Edges pass some 170 of 4096 pixels, each known to a sixteenth or so, either way.
    EXPECT_NEAR(share_of_white(picture), 0.3197, 0.001);
}

TEST(ApertureSketch, WhatIsGoneRoundTwiceIsOutside) {
    // A star of five points drawn in one line: its middle is a hole.
    std::vector<Vector2d> star;
    for (int i = 0; i < 5; ++i) {
        const double angle = 2 * 3.14159265358979 * (2 * i) / 5;
        star.emplace_back(0.5 + 0.45 * std::sin(angle), 0.5 - 0.45 * std::cos(angle));
    }
    const Image8 picture = picture_of_polygon(star, 64);
    EXPECT_EQ(picture.at(32, 32, 0), 0);
    EXPECT_EQ(picture.at(32, 12, 0), 255);
}

}  // namespace
}  // namespace matchlight
