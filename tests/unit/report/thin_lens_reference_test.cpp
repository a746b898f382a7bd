// The thin lens' reference, where its pictures are known in closed form.
#include "report/thin_lens_reference.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr double far_px = 1e6;  // where a half plane ends

double sum_of(const ImageD& picture, int channel) {
    double sum = 0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) sum += picture.at(x, y, channel);
    }
    return sum;
}

TEST(ThinLensReference, ShareOfADisc) {
    EXPECT_EQ(disc_share_before(-0.6), 0);
    EXPECT_EQ(disc_share_before(0), 0.5);
    EXPECT_EQ(disc_share_before(0.5), 1);
    // A quarter of the way in: (acos(½) − ½·√¾)/π lies outside.
    EXPECT_NEAR(disc_share_before(0.25), 1 - (std::numbers::pi / 3 - std::sqrt(3.0) / 4) / std::numbers::pi, 1e-12);
}

TEST(ThinLensReference, InFocusACardKeepsItsEdges) {
    const ThinLensView view{
        .width = 5,
        .height = 4,
        .focus = {.coc_scale_px_m = 1000, .focus_distance_m = 2},
        .bokeh = {},
        .cards = {{.left_px = 0.75, .top_px = 0.5, .right_px = 2.5, .bottom_px = 2.5, .depth_m = 2}}};
    const ImageD picture = thin_lens_light(view);
    EXPECT_DOUBLE_EQ(picture.at(1, 1, 3), 0.75);
    EXPECT_DOUBLE_EQ(picture.at(2, 1, 3), 1);
    EXPECT_DOUBLE_EQ(picture.at(3, 1, 3), 0);
    EXPECT_NEAR(sum_of(picture, 0), 1.75 * 2, 1e-12);
}

TEST(ThinLensReference, AHalfPlanesEdgeIsTheIntegralOfTheDisc) {
    const Focus focus{.coc_scale_px_m = 24, .focus_distance_m = 0.5};
    for (const double depth_m : {0.3, 1.0}) {
        const double coc_px = std::abs(signed_coc_px(focus, depth_m));
        const ThinLensView view{
            .width = 49,
            .height = 1,
            .focus = focus,
            .bokeh = {},
            .cards = {{.left_px = -far_px, .top_px = -far_px, .right_px = 24, .bottom_px = far_px, .depth_m = depth_m}},
            .lens_steps = 256};
        const ImageD picture = thin_lens_light(view);
        for (int x = 0; x < view.width; ++x) {
            double expected = 0;
            constexpr int parts = 64;  // of the pixel
            for (int i = 0; i < parts; ++i) {
                const double at = x - 0.5 + (i + 0.5) / parts;
                expected += disc_share_before((24 - at) / coc_px) / parts;
            }
            EXPECT_NEAR(picture.at(x, 0, 3), expected, 2e-4) << "x " << x << ", depth " << depth_m;
        }
    }
}

TEST(ThinLensReference, LightIsKeptAndSpreadsAsADiscDoes) {
    const Focus focus{.coc_scale_px_m = 40, .focus_distance_m = 1};
    const double coc_px = signed_coc_px(focus, 2);  // 20
    const ThinLensView view{.width = 41,
                            .height = 41,
                            .focus = focus,
                            .bokeh = {},
                            .cards = {{.left_px = 19.5,
                                       .top_px = 19.5,
                                       .right_px = 20.5,
                                       .bottom_px = 20.5,
                                       .depth_m = 2,
                                       .light = {1e5, 1e5, 1e5, 1}}}};
    const ImageD picture = thin_lens_light(view);
    EXPECT_NEAR(sum_of(picture, 1) / 1e5, 1, 1e-9);
    double variance = 0;
    for (int y = 0; y < 41; ++y) {
        for (int x = 0; x < 41; ++x) variance += (x - 20) * (x - 20) * picture.at(x, y, 0) / 1e5;
    }
    // A disc's own, of the card's and of the pixel's square.
    EXPECT_NEAR(variance, coc_px * coc_px / 16 + 2.0 / 12, 0.005 * variance);
}

TEST(ThinLensReference, WhatABlurredCardHidesIsSeenThroughIt) {
    // A half plane before the focus, over one in focus of another colour: the lens sees the one behind with the part of
    // it that the edge leaves free, up to half a circle behind the edge.
    const Focus focus{.coc_scale_px_m = 24, .focus_distance_m = 1};
    const LensCard front{.left_px = -far_px,
                         .top_px = -far_px,
                         .right_px = 20,
                         .bottom_px = far_px,
                         .depth_m = 0.6,
                         .light = {1, 0, 0, 1}};
    const LensCard behind{.left_px = -far_px,
                          .top_px = -far_px,
                          .right_px = far_px,
                          .bottom_px = far_px,
                          .depth_m = 1,
                          .light = {0, 1, 0, 1}};
    const ImageD picture =
        thin_lens_light({.width = 41, .height = 1, .focus = focus, .bokeh = {}, .cards = {behind, front}});
    for (int x = 0; x < 41; ++x) {
        EXPECT_NEAR(picture.at(x, 0, 0) + picture.at(x, 0, 1), 1, 1e-9);
        EXPECT_NEAR(picture.at(x, 0, 3), 1, 1e-9);
    }
    EXPECT_NEAR(picture.at(20, 0, 1), 0.5, 1e-9);
    EXPECT_GT(picture.at(16, 0, 1), 0.05) << "seen through the blurred edge";
    EXPECT_EQ(picture.at(11, 0, 1), 0);
}

TEST(ThinLensReference, TheOpeningsShapeIsTurnedBeforeTheFocus) {
    // A triangle with a corner to the right: beyond the focus light reaches farther to the right, before it to the
    // left.
    const Focus focus{.coc_scale_px_m = 60, .focus_distance_m = 1};
    for (const double depth_m : {0.75, 1.5}) {
        const ThinLensView view{
            .width = 41,
            .height = 41,
            .focus = focus,
            .bokeh = {.blades = 3},
            .cards = {{.left_px = 19.5, .top_px = 19.5, .right_px = 20.5, .bottom_px = 20.5, .depth_m = depth_m}}};
        const ImageD picture = thin_lens_light(view);
        const int beyond = depth_m > 1 ? 28 : 12, before = depth_m > 1 ? 12 : 28;
        EXPECT_GT(picture.at(beyond, 20, 3), 0) << depth_m;
        EXPECT_EQ(picture.at(before, 20, 3), 0) << depth_m;
    }
}

TEST(ThinLensReference, OfAPixelACircleOfAQuarterPixelMovesATenth) {
    // E|x| over a disc of radius r is 4r/3π: on either axis so much of the square leaves it, less what leaves it on
    // both.
    constexpr double coc_px = 0.25, radius_px = coc_px / 2;
    const double on_an_axis = 4 * radius_px / (3 * std::numbers::pi);
    // E|xy| = r²/(2π).
    const double on_both = radius_px * radius_px / (2 * std::numbers::pi);
    const SpreadPixel spread = spread_pixel(coc_px);
    EXPECT_NEAR(spread.moved_share, 2 * on_an_axis - on_both, 1e-5);
    EXPECT_NEAR(spread.beside_share, (on_an_axis - on_both) / 2, 1e-5);
}

}  // namespace
}  // namespace matchlight
