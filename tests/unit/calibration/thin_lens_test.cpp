// The thin lens against the textbook's forms, near its poles and at infinity.
#include "calibration/thin_lens.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

ThinLens portrait_lens() {
    return {.focal_length_m = 0.05,
            .f_number = 2,
            .focus_distance_m = 1.5,
            .sensor_width_m = 0.036,
            .image_width_px = 3600};
}

/// The circle on the sensor by rays: a point at z images at v(z), and its cone of base f/N is cut by the sensor.
double circle_by_rays_px(const ThinLens& lens, double depth_m) {
    const double f = lens.focal_length_m;
    const double sensor = 1 / (1 / f - 1 / lens.focus_distance_m), image = 1 / (1 / f - 1 / depth_m);
    return f / lens.f_number * std::abs(image - sensor) / image / (lens.sensor_width_m / lens.image_width_px);
}

TEST(ThinLens, CircleIsWhereTheSensorCutsTheCone) {
    const ThinLens lens = portrait_lens();
    const Focus focus = focus_of(lens);
    for (const double depth : {0.2, 0.8, 1.49, 1.5, 1.51, 3.0, 100.0, 1e6}) {
        EXPECT_NEAR(std::abs(signed_coc_px(focus, depth)), circle_by_rays_px(lens, depth), 1e-6) << depth;
    }
    EXPECT_LT(signed_coc_px(focus, 1.0), 0);
    EXPECT_GT(signed_coc_px(focus, 2.0), 0);
}

TEST(ThinLens, HoldsAtInfinityAndAtTheLens) {
    ThinLens lens = portrait_lens();
    // Infinity in the background: what f²/(N(z_f − f)) says, in pixels of 10 µm.
    EXPECT_NEAR(signed_coc_px(focus_of(lens), infinity), 0.05 * 0.05 / 2 / (1.5 - 0.05) / 1e-5, 1e-9);
    EXPECT_EQ(signed_coc_px(focus_of(lens), 0), -infinity);
    lens.focus_distance_m = infinity;
    EXPECT_DOUBLE_EQ(image_distance_m(lens), 0.05);
    EXPECT_EQ(signed_coc_px(focus_of(lens), infinity), 0);
    EXPECT_NEAR(signed_coc_px(focus_of(lens), 10), -0.05 / 2 * 0.05 / 10 / 1e-5, 1e-9);
    // A focus far away is no different from infinity.
    lens.focus_distance_m = 1e12;
    EXPECT_NEAR(signed_coc_px(focus_of(lens), 10), -12.5, 1e-6);
}

TEST(ThinLens, KeepsItsDigitsNearTheFocus) {
    const Focus focus{1e6, 3.0};
    const double step = 3.0 * std::ldexp(1, -40);  // the difference of the inverses has lost 40 of 53 bits here
    EXPECT_NEAR(signed_coc_px(focus, 3.0 + step) / (1e6 * step / 9), 1, 1e-9);
}

TEST(ThinLens, LimitsAreWhereTheCircleReachesWhatIsAcceptable) {
    const Focus focus = focus_of(portrait_lens());
    const DepthOfField depths = depth_of_field(focus, 3);
    EXPECT_NEAR(signed_coc_px(focus, depths.near_m), -3, 1e-9);
    EXPECT_NEAR(signed_coc_px(focus, depths.far_m), 3, 1e-9);
    EXPECT_EQ(depth_of_field(focus, 1000).far_m, infinity);
    EXPECT_EQ(depth_of_field({0, 1}, 1).near_m, 0);  // a pinhole
}

TEST(ThinLens, FocusedAtTheHyperfocalDistanceInfinityIsJustAcceptable) {
    ThinLens lens = portrait_lens();
    const double hyperfocal = hyperfocal_m(lens, 3);
    EXPECT_NEAR(hyperfocal, 0.05 * 0.05 / (2 * 3e-5) + 0.05, 1e-9);
    lens.focus_distance_m = hyperfocal;
    EXPECT_NEAR(signed_coc_px(focus_of(lens), infinity), 3, 1e-9);
    // And half of it is the near limit, but for the distance from the lens' own focal point.
    EXPECT_NEAR(depth_of_field(focus_of(lens), 3).near_m, hyperfocal / 2, 1e-9);
    const Focus focus{24, infinity};
    EXPECT_NEAR(signed_coc_px({24, hyperfocal_m(focus, 1.5)}, infinity), 1.5, 1e-12);
}

}  // namespace
}  // namespace matchlight
