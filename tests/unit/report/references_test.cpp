// The references that reports hold effects against, where answers are known in closed form.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "report/contact_shadow_reference.h"
#include "report/prefilter_reference.h"
#include "report/shadow_reference.h"
#include "scene/ray_caster.h"

namespace matchlight {
namespace {

/// A square of half side `half_m` at height `z_m`.
struct Square {
    std::vector<Eigen::Vector3d> positions;
    std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};

    Square(double half_m, double z_m)
        : positions{{-half_m, -half_m, z_m}, {half_m, -half_m, z_m}, {half_m, half_m, z_m}, {-half_m, half_m, z_m}} {}
};

RayCaster caster_of(const Square& square) {
    RayCaster caster;
    caster.add_mesh(square.positions, square.indices);
    caster.build();
    return caster;
}

Probe even_light(int width = 64) {
    return {ImageF(width, width / 2, 3, 1.0F)};
}

TEST(RayCaster, FindsTheNearestOfTwoSquares) {
    const Square near(1, 2), far(3, 5);
    RayCaster caster;
    caster.add_mesh(near.positions, near.indices);
    caster.add_mesh(far.positions, far.indices);
    caster.build();
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const auto first = caster.nearest({0.5, 0.5, 0}, up, 0);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->mesh, 0);
    EXPECT_NEAR(first->distance_m, 2, 1e-12);
    const auto beside = caster.nearest({2, 0, 0}, up, 0);
    ASSERT_TRUE(beside);
    EXPECT_EQ(beside->mesh, 1);
    EXPECT_NEAR(beside->distance_m, 5, 1e-12);
    EXPECT_FALSE(caster.nearest({4, 0, 0}, up, 0));
    EXPECT_FALSE(caster.nearest({0, 0, 0}, -up, 0));
    EXPECT_EQ(caster.nearest({0, 0, 0}, up, 3)->mesh, 1);
}

TEST(RayCaster, OfNothingIsNeverHit) {
    RayCaster caster;
    caster.build();
    EXPECT_FALSE(caster.nearest({0, 0, 0}, Eigen::Vector3d::UnitX(), 0));
}

TEST(ContactShadowReference, OfASquareOverheadIsItsViewFactor) {
    const Square square(1, 1);
    const RayCaster caster = caster_of(square);
    const std::vector<double> black{0.0};
    // As many pixels of light that no stratum is a single one.
    const ContactShadowReference reference({0, sample_directions(even_light(512), 4096, 0, true), 0}, caster, black);
    // From under the middle of a parallel square of half side a at distance h, with X = a/h:
    // F = (4/π)·X/√(1+X²)·atan(X/√(1+X²)), four times that of a corner.
    const double x = 1, side = x / std::sqrt(1 + x * x);
    const double view_factor = 4 / std::numbers::pi * side * std::atan(side);
    const Eigen::Vector3d left = reference.ratio({0, 0});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(left[c], 1 - view_factor, 0.004);
    EXPECT_NEAR(reference.ratio({1000, 0}).x(), 1, 1e-6);
}

TEST(ContactShadowReference, AgreesWithTheSumOverThePixels) {
    Probe probe = even_light();
    for (int c = 0; c < 3; ++c) probe.latlong.at(40, 6, c) = 300;
    const Square square(0.4, 0.5);
    const RayCaster caster = caster_of(square);
    const std::vector<double> black{0.0};
    const ContactShadowReference reference({0, sample_directions(probe, 4096, 0, true), 0}, caster, black);
    const Occlusion occluded = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& direction) {
        return caster.nearest(point, direction, 0).has_value();
    };
    for (const double along : {-0.6, 0.0, 0.3, 0.9}) {
        const Eigen::Vector3d pixels = reference_contact_shadow(probe, {along, 0.1, 0}, occluded);
        EXPECT_NEAR(reference.ratio({along, 0.1}).x(), pixels.x(), 0.02) << along;
    }
}

TEST(ContactShadowReference, WhiteCastersReturnLight) {
    const Square square(1, 1);
    const RayCaster caster = caster_of(square);
    const std::vector<double> black{0.0}, white{1.0};
    const ReferenceSurface surface{0, sample_directions(even_light(), 1024, 0, true), 0.5 / std::numbers::pi};
    const double dark = ContactShadowReference(surface, caster, black).ratio({0, 0}).x();
    const double lit = ContactShadowReference(surface, caster, white).ratio({0, 0}).x();
    // Half of what is blocked comes back of the half that the surface sends: r = open + ½·blocked·r.
    EXPECT_NEAR(lit, dark / (1 - 0.5 * (1 - dark)), 0.01);
}

TEST(VertexShadowReference, HalvesTheLightBesideAWall) {
    // An infinite wall hides half of the hemisphere of a point that stands before it and faces up.
    const std::vector<Eigen::Vector3d> wall{
        {0.001, -1e4, -1e4}, {0.001, 1e4, -1e4}, {0.001, 1e4, 1e4}, {0.001, -1e4, 1e4}};
    RayCaster caster;
    caster.add_mesh(wall, std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
    caster.build();
    const std::vector<DirectionalSample> samples = sample_directions(even_light(), 2048, -1, false);
    const VertexShadowReference reference{samples, caster,
                                          [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return 1.0; }, 0};
    const Eigen::Vector3d half = reference.visibility(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(half[c], 0.5, 0.01);
    EXPECT_NEAR(reference.visibility(Eigen::Vector3d::Zero(), -Eigen::Vector3d::UnitX()).x(), 1, 1e-9);
}

TEST(PrefilterReference, LeavesEvenLightAsItIs) {
    for (const double roughness : {0.1, 0.5, 1.0}) {
        const ImageF picture = reference_glossy_latlong(even_light(), roughness, 8);
        for (const float value : picture.samples()) EXPECT_NEAR(value, 1, 1e-5) << roughness;
    }
    const ImageF mirror = reference_mirror_latlong(even_light(), 2, 8);
    for (const float value : mirror.samples()) EXPECT_NEAR(value, 1, 1e-5);
}

TEST(PrefilterReference, SpreadsALampMoreTheRougherItIs) {
    Probe probe = {ImageF(64, 32, 3)};
    probe.latlong.at(32, 16, 0) = 1000;
    double last = 1e9;
    for (const double roughness : {0.2, 0.4, 0.8}) {
        const ImageF picture = reference_glossy_latlong(probe, roughness, 64);
        EXPECT_LT(picture.at(32, 16, 0), last) << roughness;
        EXPECT_GT(picture.at(32, 16, 0), picture.at(40, 16, 0));
        last = picture.at(32, 16, 0);
    }
}

}  // namespace
}  // namespace matchlight
