// Analytic lights on objects against the double-precision reference, and where they are stiff.
#include "render/lamps.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render_scene.h"
#include "report/lamp_reference.h"
#include "report/material_reference.h"

namespace matchlight::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int size = 100;
constexpr double pixel_m = 0.004;

Eigen::Vector3d seen_at(int x, int y) {
    return {(x - (size - 1) / 2.0) * pixel_m, ((size - 1) / 2.0 - y) * pixel_m, 0};
}

LampSettings point_lamp() {
    return {.type = LampType::point, .color = {1, 0.5, 0.25}, .intensity = 2, .position_m = {0.1, 0.05, 0.3}};
}
LampSettings spot_lamp() {
    LampSettings lamp = point_lamp();
    lamp.type = LampType::spot;
    lamp.direction = {-0.3, 0, -1};
    lamp.inner_cone_deg = 10;
    lamp.outer_cone_deg = 25;
    lamp.range_m = 0.5;
    return lamp;
}
LampSettings sun() {
    return {.type = LampType::directional, .intensity = 3, .direction = {0.5, 0.2, -1}};
}

class LampsTest : public GlTest {
protected:
    /// A white plane and, where it has a radius, a ball over it, under nothing but the lamp.
    ImageF draw(const LampSettings& lamp, double ball_radius_m = 0) {
        SurfaceRenderer surfaces(shaders_);
        const Model plane = make_square(0.4), ball = make_sphere(ball_radius_m > 0 ? ball_radius_m : 1);
        surfaces.add_object(white_diffuse(plane));
        if (ball_radius_m > 0) {
            SurfaceObject object = white_diffuse(ball);
            object.world_from_model.block<3, 1>(0, 3) = ball_centre;
            surfaces.add_object(object);
        }
        return draw(surfaces, lamp);
    }
    ImageF draw(SurfaceRenderer& surfaces, const LampSettings& lamp) {
        const Environment environment(shaders_, uniform_probe(0));
        Lamps lamps(std::vector<LampSettings>{lamp});
        lamps.draw_maps(
            shaders_,
            {surfaces.shadow_caster_bounds_m(), [&](Program& program) { surfaces.draw_shadow_casters(program); }},
            quality_, true);
        SurfaceShading shading{.bind = [&](Program& program) { lamps.bind(program); }};
        shading.has_lamps = true;
        const SurfaceView view = from_above();
        return surfaces.draw(environment, view, shading).color->read<float>({0, 0, view.width, view.height}, 4);
    }
    /// The mean difference from the reference as a share of the brightest place, where the ball does not hide the
    /// plane.
    static double mean_error(const ImageF& drawn, const LampSettings& lamp, double ball_radius_m = 0) {
        const Blocked blocked = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
            const Eigen::Vector3d direction = (to - from).normalized();
            const double along = (ball_centre - from).dot(direction);
            return along > 0 && (ball_centre - from - along * direction).norm() < ball_radius_m;
        };
        double sum = 0, brightest = 0;
        int count = 0;
        for (int y = 3; y < size; y += 4) {
            for (int x = 3; x < size; x += 4) {
                const Eigen::Vector3d point = seen_at(x, y);
                if ((point - ball_centre).head<2>().norm() < 1.2 * ball_radius_m) continue;
                const Eigen::Vector3d expected =
                    reference_lamp_irradiance(lamp, point, Eigen::Vector3d::UnitZ(), blocked, 400) / pi;
                brightest = std::max(brightest, expected.maxCoeff());
                for (int c = 0; c < 3; ++c) sum += std::abs(drawn.at(x, y, c) - expected[c]) / 3;
                ++count;
            }
        }
        EXPECT_GT(count, 200);
        EXPECT_GT(brightest, 0);
        return sum / count / brightest;
    }

    static inline const Eigen::Vector3d ball_centre{0, 0, 0.08};
    ShaderLibrary shaders_;
    LampQuality quality_;
};

TEST_F(LampsTest, LightsAPlaneAsTheReferenceDoes) {
    // Half floats have 11 bits, and some drivers cut the rest off instead of rounding it.
    for (const LampSettings& lamp : {point_lamp(), spot_lamp(), sun()})
        EXPECT_LT(mean_error(draw(lamp), lamp), 1.0 / 1024) << static_cast<int>(lamp.type);
}

TEST_F(LampsTest, ABallCastsAHardShadow) {
    // The map's texel is a tenth of a picture's pixel: what differs are pixels on the shadow's edge.
    for (const LampSettings& lamp : {point_lamp(), sun()})
        EXPECT_LT(mean_error(draw(lamp, 0.05), lamp, 0.05), 0.004) << static_cast<int>(lamp.type);
}

TEST_F(LampsTest, ALampOfSomeSizeCastsASoftShadow) {
    LampSettings ball = point_lamp(), disc = sun();
    ball.radius_m = 0.03;
    disc.angle_deg = 10;
    // One map shows how far the casters are, and not what lies behind their rim.
    for (const LampSettings& lamp : {ball, disc}) {
        const ImageF soft = draw(lamp, 0.05);
        EXPECT_LT(mean_error(soft, lamp, 0.05), 0.02) << static_cast<int>(lamp.type);
        LampSettings hard = lamp;
        hard.radius_m = hard.angle_deg = 0;
        EXPECT_GT(mean_error(draw(hard, 0.05), lamp, 0.05), 1.3 * mean_error(soft, lamp, 0.05));
    }
}

TEST_F(LampsTest, ALampAmongTheCastersSeesThemAllRound) {
    LampSettings lamp = point_lamp();
    lamp.position_m = {0.12, 0, 0.1};
    const ImageF drawn = draw(lamp, 0.05);
    EXPECT_LT(mean_error(drawn, lamp, 0.05), 0.01);
}

TEST_F(LampsTest, AConvexBodyShadesItselfNowhereThatFacesTheLamp) {
    SurfaceRenderer surfaces(shaders_);
    const Model ball = make_sphere(0.1);
    surfaces.add_object(white_diffuse(ball));
    LampSettings lamp = sun();
    const ImageF shaded = draw(surfaces, lamp);
    lamp.casts_shadow = false;
    const ImageF open = draw(surfaces, lamp);
    double darkest = 1;
    int lit = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            // Where light grazes the ball by less than 10° a map's texels are wider than what they tell apart.
            if (open.at(x, y, 1) * pi < 0.17 * lamp.intensity) continue;
            darkest = std::min<double>(darkest, shaded.at(x, y, 1) / open.at(x, y, 1));
            ++lit;
        }
    }
    EXPECT_GT(lit, 800);
    EXPECT_GT(darkest, 0.999);
}

TEST_F(LampsTest, GlossyMaterialsMirrorALampAsTheReferenceDoes) {
    Model plane = make_square(0.4);
    for (const double metallic : {0.0, 1.0}) {
        ModelMaterial& material = plane.materials[0];
        material.base_color = {0.7F, 0.4F, 0.2F, 1};
        material.metallic = static_cast<float>(metallic);
        material.roughness = 0.5F;
        SurfaceRenderer surfaces(shaders_);
        surfaces.add_object({.model = &plane});
        LampSettings lamp = point_lamp();
        lamp.radius_m = 0.02;
        const ImageF drawn = draw(surfaces, lamp);
        const Eigen::Vector3d eye = from_above().eye_world_m;
        for (const auto& [x, y] : {std::pair{50, 50}, {74, 40}, {60, 45}}) {
            const Eigen::Vector3d point = seen_at(x, y);
            const Eigen::Vector3d way = lamp.position_m - point;
            const double cosine = std::sqrt(1 - std::pow(lamp.radius_m / way.norm(), 2));
            const Eigen::Vector3d radiance = lamp.intensity * lamp.color / (pi * lamp.radius_m * lamp.radius_m);
            const Eigen::Vector3d expected = material_reference(
                material, {.to_eye = (eye - point).normalized()},
                [&](const Eigen::Vector3d& direction) -> Eigen::Vector3d {
                    return direction.dot(way.normalized()) > cosine ? radiance : Eigen::Vector3d::Zero();
                },
                400000);
            // The table of the split sum is as good as a hundredth; the lobe is widened for the lamp's size, not
            // convolved with it.
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(drawn.at(x, y, c), expected[c], 0.03 * expected[c]) << metallic << " " << x << " " << c;
        }
    }
}

TEST_F(LampsTest, StiffLampsStayFinite) {
    LampSettings on_surface = point_lamp(), inside = point_lamp(), strong = point_lamp(), closed = spot_lamp();
    LampSettings half = spot_lamp(), hard = spot_lamp();
    on_surface.position_m = {0.002, -0.002, 0};  // where a pixel looks
    inside.position_m = ball_centre;
    strong.intensity = 1e9;
    closed.inner_cone_deg = closed.outer_cone_deg = 0;
    half.outer_cone_deg = half.inner_cone_deg = 90;
    hard.inner_cone_deg = hard.outer_cone_deg;
    for (const LampSettings& lamp : {on_surface, inside, strong, closed, half, hard}) {
        const ImageF drawn = draw(lamp, 0.05);
        float most = 0;
        for (const float value : drawn.samples()) {
            ASSERT_TRUE(std::isfinite(value));
            ASSERT_GE(value, 0);
            most = std::max(most, value);
        }
        EXPECT_LE(most, 65504);
    }
    const ImageF dark = draw(closed);
    EXPECT_EQ(dark.at(50, 50, 0), 0) << "a closed spot sends out nothing";
    EXPECT_LT(mean_error(draw(hard), hard), 0.005) << "the cone's edge";
    // From inside a closed body nothing leaves.
    const ImageF hidden = draw(inside, 0.05);
    EXPECT_EQ(hidden.at(2, 2, 1), 0);
}

TEST_F(LampsTest, QualityIsChecked) {
    EXPECT_THROW(LampQuality{.resolution = 8}.check(), std::invalid_argument);
    EXPECT_THROW(LampQuality{.taps = 0}.check(), std::invalid_argument);
    EXPECT_THROW(LampQuality{.rays = -1}.check(), std::invalid_argument);
    EXPECT_THROW(LampQuality{.surface_points = 0}.check(), std::invalid_argument);
}

}  // namespace
}  // namespace matchlight::test
