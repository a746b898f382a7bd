// Mappings: inverse both ways, axes of INTERFACE, and solid angles that cover the sphere.
#include "lighting/mappings.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "synthetic_probes.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::random_direction;

constexpr double pi = std::numbers::pi;
const Vector3d forward = Vector3d::UnitY(), right = Vector3d::UnitX(), up = Vector3d::UnitZ();

std::vector<ProbeLayout> all_layouts() {
    std::vector<ProbeLayout> layouts = {layout_of_size(ProbeMapping::latlong, 100),
                                        layout_of_size(ProbeMapping::angular, 151),
                                        layout_of_size(ProbeMapping::mirrorball, 150)};
    for (const auto cube :
         {CubeLayout::vertical_cross, CubeLayout::horizontal_cross, CubeLayout::strip, CubeLayout::column}) {
        layouts.push_back(layout_of_size(ProbeMapping::cube, 33, cube));
        layouts.push_back(layouts.back());
        layouts.back().edge_centred = true;
    }
    layouts.push_back(layouts[0]);
    layouts.back().edge_centred = true;
    return layouts;
}

void expect_shown(const ProbeLayout& layout, double x, double y, const Vector3d& expected) {
    const auto found = direction_from_pixel(layout, {x, y});
    ASSERT_TRUE(found.has_value()) << x << " " << y;
    EXPECT_NEAR((*found - expected.normalized()).norm(), 0, 1e-9) << x << " " << y << ": " << found->transpose();
}

TEST(Mappings, AreInverseOnRandomDirections) {
    std::mt19937 generator(7);
    for (const ProbeLayout& layout : all_layouts()) {
        for (int i = 0; i < 5000; ++i) {
            const Vector3d direction = random_direction(generator);
            if (layout.edge_centred && layout.mapping == ProbeMapping::cube) continue;  // faces overlap: tested below
            const auto back = direction_from_pixel(layout, pixel_from_direction(layout, direction));
            ASSERT_TRUE(back.has_value()) << name_of(layout.mapping);
            // Rounding, amplified at a mirror ball's rim where a pixel holds 1/√ of the angle.
            EXPECT_NEAR((*back - direction).norm(), 0, 1e-7) << name_of(layout.mapping);
        }
    }
}

TEST(Mappings, EdgeCentredFacesAreInverseAtPixelCentres) {
    for (const ProbeLayout& layout : all_layouts()) {
        if (layout.mapping != ProbeMapping::cube) continue;
        for (int y = 0; y < layout.height; ++y) {
            for (int x = 0; x < layout.width; ++x) {
                const auto direction = direction_from_pixel(layout, Vector2d(x, y));
                if (!direction) continue;
                const Vector2d pixel = pixel_from_direction(layout, *direction);
                const auto again = direction_from_pixel(layout, pixel.array().round().matrix());
                ASSERT_TRUE(again.has_value());
                EXPECT_NEAR((*again - *direction).norm(), 0, 1e-9);
            }
        }
    }
}

TEST(Mappings, AngularMapLooksForwardWithUpAboveAndRightOnTheRight) {
    const ProbeLayout layout = layout_of_size(ProbeMapping::angular, 201);
    expect_shown(layout, 100, 100, forward);
    expect_shown(layout, 100 + 201 / 4.0, 100, right);  // 90° at half the radius
    expect_shown(layout, 100, 100 - 201 / 4.0, up);
    expect_shown(layout, 100 + 201 / 8.0, 100, forward + right);
    expect_shown(layout, 200.5, 100, -forward);  // the rim is straight behind
    EXPECT_FALSE(direction_from_pixel(layout, {5, 5}).has_value());
}

TEST(Mappings, MirrorBallShowsNinetyDegreesAtTheSineOfFortyFive) {
    const ProbeLayout layout = layout_of_size(ProbeMapping::mirrorball, 201);
    const double radius = 100.5 * std::sin(pi / 4);
    expect_shown(layout, 100, 100, forward);
    expect_shown(layout, 100 + radius, 100, right);
    expect_shown(layout, 100, 100 - radius, up);
    expect_shown(layout, 100 - radius, 100, -right);
}

TEST(Mappings, VerticalCrossFoldsIntoACube) {
    const ProbeLayout layout = layout_of_size(ProbeMapping::cube, 11);
    EXPECT_EQ(layout.width, 33);
    EXPECT_EQ(layout.height, 44);
    expect_shown(layout, 16, 16, forward);
    expect_shown(layout, 27, 16, right);
    expect_shown(layout, 5, 16, -right);
    expect_shown(layout, 16, 5, up);
    expect_shown(layout, 16, 27, -up);
    expect_shown(layout, 16, 38, -forward);
    // Along the column up, forward, down, back nothing jumps: neighbours across a fold are neighbours in space.
    for (int y = 0; y + 1 < 44; ++y) {
        const auto a = direction_from_pixel(layout, Vector2d(13, y));
        const auto b = direction_from_pixel(layout, Vector2d(13, y + 1));
        EXPECT_LT(std::acos(a->dot(*b)), 2.0 / 11 + 0.01) << y;
    }
    for (int x = 0; x + 1 < 33; ++x) {
        const auto a = direction_from_pixel(layout, Vector2d(x, 13));
        const auto b = direction_from_pixel(layout, Vector2d(x + 1, 13));
        EXPECT_LT(std::acos(a->dot(*b)), 2.0 / 11 + 0.01) << x;
    }
    EXPECT_FALSE(direction_from_pixel(layout, {2, 2}).has_value());
}

TEST(Mappings, HorizontalCrossRunsAroundTheHorizon) {
    const ProbeLayout layout = layout_of_size(ProbeMapping::cube, 11, CubeLayout::horizontal_cross);
    for (int x = 0; x + 1 < 44; ++x) {
        const auto a = direction_from_pixel(layout, Vector2d(x, 13));
        const auto b = direction_from_pixel(layout, Vector2d(x + 1, 13));
        EXPECT_LT(std::acos(a->dot(*b)), 2.0 / 11 + 0.01) << x;
    }
    expect_shown(layout, 38, 16, -forward);
}

TEST(Mappings, StripHasTheFacesOfOpenGlInOrder) {
    const ProbeLayout layout = layout_of_size(ProbeMapping::cube, 10, CubeLayout::strip);
    const Vector3d middles[6] = {right, -right, up, -up, forward, -forward};
    for (int face = 0; face < 6; ++face) expect_shown(layout, 10 * face + 4.5, 4.5, middles[face]);
    expect_shown(layout, 20 + 4.5, 9.5 - 1e-9, up + forward);  // the lower edge of up joins forward
    expect_shown(layout, 30 + 4.5, -0.5, -up + forward);       // the upper edge of down too
}

TEST(Mappings, ColumnIsOpenExrs) {
    // ImfEnvmap.h: +X −X +Y −Y +Z −Z, right-handed, +Y up; OpenEXR's +Z is our forward, its +X our left.
    ProbeLayout layout = layout_of_size(ProbeMapping::cube, 11, CubeLayout::column);
    layout.edge_centred = true;
    const Vector3d exr_x = -right, exr_y = up, exr_z = forward;
    const Vector3d middles[6] = {exr_x, -exr_x, exr_y, -exr_y, exr_z, -exr_z};
    for (int face = 0; face < 6; ++face) expect_shown(layout, 5, 11 * face + 5, middles[face]);
    // Corners of its picture of the cube: "3" = (+,+,−) lies top left on +X, "7" = (+,+,+) top right.
    expect_shown(layout, 0, 0, exr_x + exr_y - exr_z);
    expect_shown(layout, 10, 0, exr_x + exr_y + exr_z);
    expect_shown(layout, 0, 11, -exr_x + exr_y + exr_z);  // "6", −X
    expect_shown(layout, 0, 22, -exr_x + exr_y + exr_z);  // "6", +Y
    expect_shown(layout, 0, 33, -exr_x - exr_y - exr_z);  // "0", −Y
    expect_shown(layout, 0, 44, exr_x + exr_y + exr_z);   // "7", +Z
    expect_shown(layout, 0, 55, -exr_x + exr_y - exr_z);  // "2", −Z
}

TEST(Mappings, SolidAnglesOfAllPixelsAreTheSphere) {
    for (const ProbeLayout& layout : all_layouts()) {
        double sum = 0;
        for (const double solid_angle : pixel_solid_angles(layout)) sum += solid_angle;
        EXPECT_NEAR(sum, 4 * pi, 1e-9) << name_of(layout.mapping);
    }
}

TEST(Mappings, DensityIsTheJacobianOfTheDirection) {
    std::mt19937 generator(8);
    for (const ProbeLayout& layout : all_layouts()) {
        for (int i = 0; i < 300; ++i) {
            const Vector2d pixel = pixel_from_direction(layout, random_direction(generator));
            const double h = 1e-4;
            const auto x0 = direction_from_pixel(layout, pixel - Vector2d(h, 0));
            const auto x1 = direction_from_pixel(layout, pixel + Vector2d(h, 0));
            const auto y0 = direction_from_pixel(layout, pixel - Vector2d(0, h));
            const auto y1 = direction_from_pixel(layout, pixel + Vector2d(0, h));
            if (!x0 || !x1 || !y0 || !y1) continue;
            const double numeric = (*x1 - *x0).cross(*y1 - *y0).norm() / (4 * h * h);
            const double stated = solid_angle_density(layout, pixel);
            // Central differences are good to h²; steps over a face's edge are not, and leave out one in 300.
            if ((*x1 - *x0).norm() > 0.01 || (*y1 - *y0).norm() > 0.01) continue;
            EXPECT_NEAR(numeric, stated, 1e-3 * stated + 1e-9) << name_of(layout.mapping);
        }
    }
}

TEST(Mappings, APixelsReachIsItsHalfDiagonalAndGrowsToTheRim) {
    const ProbeLayout latlong = layout_of_size(ProbeMapping::latlong, 90);
    // 2° pixels on the horizon: 0.96 of half a diagonal, from the centre.
    const Vector3d centre = *direction_from_pixel(latlong, Vector2d(90, 45));
    EXPECT_NEAR(reach_of_pixel(latlong, centre), 0.96 * std::numbers::sqrt2 * std::numbers::pi / 180, 1e-4);
    const ProbeLayout ball = layout_of_size(ProbeMapping::mirrorball, 100);
    EXPECT_LT(reach_of_pixel(ball, {0.01, 1, 0.01}), 0.06);
    EXPECT_GT(reach_of_pixel(ball, {0.01, -1, 0.01}), 0.2);  // straight behind: the rim's pixels reach 16°
}

TEST(Mappings, TapsSumToOneAndLieInTheImage) {
    std::mt19937 generator(9);
    for (const ProbeLayout& layout : all_layouts()) {
        for (int i = 0; i < 3000; ++i) {
            const Vector3d direction = random_direction(generator);
            double sum = 0;
            for (const PixelTap& tap : bilinear_taps(layout, direction)) {
                EXPECT_TRUE(Region({0, 0, layout.width, layout.height}).contains(tap.x, tap.y));
                sum += tap.weight;
                EXPECT_TRUE(tap.weight == 0 || direction_from_pixel(layout, Vector2d(tap.x, tap.y)).has_value());
            }
            EXPECT_NEAR(sum, 1, 1e-12);
            const Eigen::Vector2i nearest = nearest_pixel(layout, direction);
            EXPECT_TRUE(direction_from_pixel(layout, nearest.cast<double>()).has_value());
        }
    }
}

TEST(Mappings, ShapesNameCubes) {
    EXPECT_EQ(cube_layout_of_shape(300, 400), CubeLayout::vertical_cross);
    EXPECT_EQ(cube_layout_of_shape(400, 300), CubeLayout::horizontal_cross);
    EXPECT_EQ(cube_layout_of_shape(600, 100), CubeLayout::strip);
    EXPECT_EQ(cube_layout_of_shape(100, 600), CubeLayout::column);
    EXPECT_FALSE(cube_layout_of_shape(200, 100).has_value());
    EXPECT_FALSE(cube_layout_of_shape(301, 400).has_value());
}

}  // namespace
}  // namespace matchlight
