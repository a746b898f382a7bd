// Shadows between objects against the double-precision reference, and what leaving shadows out changes: nothing.
#include "render/effects/object_shadow.h"

#include <numbers>

#include <gtest/gtest.h>

#include "composite_noise.h"
#include "gl/framebuffer.h"
#include "gl_fixture.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render_scene.h"
#include "report/contact_shadow_reference.h"
#include "scene/subdivide.h"

namespace matchlight {
namespace {

class ObjectShadowTest : public GlTest {
protected:
    ShaderLibrary shaders_;
};

/// A dim sky with a lamp 20° across, 60° above the horizon.
Probe sky_with_lamp() {
    const Eigen::Vector3d lamp(0.5, 0, std::sqrt(0.75));
    return test::make_probe(128, [&](const Eigen::Vector3d& d) -> Eigen::Vector3d {
        const bool in_lamp = d.dot(lamp) > std::cos(10 * std::numbers::pi / 180);
        return Eigen::Vector3d::Constant(0.5 + (in_lamp ? 20 : 0));
    });
}

TEST_F(ObjectShadowTest, DimsAPlaneUnderASphereAsTheReferenceDoes) {
    const Eigen::Vector3d centre(0, 0, 0.08);
    constexpr double radius = 0.05;
    Model plane = test::make_square(0.4);
    plane.meshes[0] = with_short_edges(plane.meshes[0], 0.005, 100000);
    const Model sphere = test::make_sphere(radius);
    SurfaceRenderer surfaces(shaders_);
    surfaces.add_object(test::white_diffuse(plane));
    SurfaceObject ball = test::white_diffuse(sphere);
    ball.world_from_model.block<3, 1>(0, 3) = centre;
    surfaces.add_object(ball);
    const Probe probe = sky_with_lamp();
    const Environment environment(shaders_, probe);
    const SurfaceView view = test::from_above();
    const auto read = [&] {
        return surfaces.draw(environment, view).color->read<float>({0, 0, view.width, view.height}, 4);
    };
    const ImageF open = read();

    const ShadowCasters casters{surfaces.shadow_caster_bounds_m(),
                                [&](Program& program) { surfaces.draw_shadow_casters(program); }};
    const ObjectShadow shadow(shaders_, casters, sample_directions(probe, 256, -1, false),
                              {.directions = 256, .resolution = 512});
    Program& bake = shaders_.compute("effects/object_shadow/bake.comp");
    bake.use();
    shadow.bind(bake, SurfaceShading::first_free_unit);
    surfaces.bake_visibility(bake);
    const ImageF shaded = read();

    const Occlusion sphere_occludes = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& direction) {
        const Eigen::Vector3d to_centre = centre - point;
        const double along = to_centre.dot(direction);
        return along > 0 && (to_centre - along * direction).norm() < radius;
    };
    double sum = 0;
    int count = 0;
    for (int y = 10; y < 90; y += 4) {
        for (int x = 10; x < 90; x += 4) {
            const Eigen::Vector3d point((x - 49.5) * 0.004, (49.5 - y) * 0.004, 0);
            if (point.norm() < 1.2 * radius) continue;  // the ball hides the plane there
            const Eigen::Vector3d reference = reference_contact_shadow(probe, point, sphere_occludes);
            sum += std::abs(shaded.at(x, y, 1) / open.at(x, y, 1) - reference.y());
            ++count;
        }
    }
    // 256 directions over the whole sphere leave some 60 to the lamp, whose penumbra covers a good part of the picture.
    EXPECT_LT(sum / count, 0.02);
    EXPECT_GT(count, 200);
}

TEST_F(ObjectShadowTest, AConvexBodyAloneShadesItselfNowhere) {
    const Model sphere = test::make_sphere(0.1);
    SurfaceRenderer surfaces(shaders_);
    surfaces.add_object(test::white_diffuse(sphere));
    const Probe probe = sky_with_lamp();
    const Environment environment(shaders_, probe);
    const SurfaceView view = test::from_above();
    const auto read = [&] {
        return surfaces.draw(environment, view).color->read<float>({0, 0, view.width, view.height}, 4);
    };
    const ImageF open = read();
    const ShadowCasters casters{surfaces.shadow_caster_bounds_m(),
                                [&](Program& program) { surfaces.draw_shadow_casters(program); }};
    const ObjectShadow shadow(shaders_, casters, sample_directions(probe, 64, -1, false), {});
    Program& bake = shaders_.compute("effects/object_shadow/bake.comp");
    bake.use();
    shadow.bind(bake, SurfaceShading::first_free_unit);
    surfaces.bake_visibility(bake);
    const ImageF shaded = read();
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            if (open.at(x, y, 3) < 1) continue;
            EXPECT_NEAR(shaded.at(x, y, 1) / open.at(x, y, 1), 1, 0.02) << x << ' ' << y;
        }
    }
}

TEST_F(ObjectShadowTest, LeavingOutAContactShadowThatTakesNothingChangesNoBit) {
    ContactShadow nothing;
    for (ShadowMap* map : {&nothing.fine, &nothing.far}) {
        map->loss = Texture2D({.format = GL_RGBA32F, .width = 16, .height = 16});
        map->loss.clear(0, 0, 0, 0);
        map->rectangle_m = {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, 1)};
    }
    const ImageF with = test::composite_noise(shaders_, {.shadow = &nothing});
    const ImageF without = test::composite_noise(shaders_, {});
    EXPECT_TRUE(std::ranges::equal(with.samples(), without.samples()));

    // And a shadow that does take light is seen by this test.
    nothing.fine.loss.clear(0.25F, 0.25F, 0.25F, 0);
    const ImageF shaded = test::composite_noise(shaders_, {.shadow = &nothing});
    EXPECT_FALSE(std::ranges::equal(shaded.samples(), without.samples()));
    for (int x = 0; x < 64; x += 7) {
        const double code = without.at(x, 20, 1);
        EXPECT_NEAR(shaded.at(x, 20, 1), code * std::pow(0.75, 1 / 2.2), 2e-4);
    }
}

TEST_F(ObjectShadowTest, TheFootprintHoldsEveryTexelThatLosesLight) {
    ContactShadow shadow;
    shadow.far.rectangle_m = {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, 1)};
    shadow.far.loss = Texture2D({.format = GL_RGBA32F, .width = 100, .height = 100});
    shadow.fine.rectangle_m = {Eigen::Vector2d(-0.1, -0.1), Eigen::Vector2d(0.1, 0.1)};
    shadow.fine.loss = Texture2D({.format = GL_RGBA32F, .width = 100, .height = 100});
    shadow.fine.loss.clear(0, 0, 0, 0);
    ImageF loss(100, 100, 4);
    loss.at(70, 20, 1) = 0.5F;  // x = 0.41, y = −0.59
    shadow.far.loss.upload(loss);
    const ShadowFootprint footprint(shadow.far, shadow.fine, 0.002);
    const auto around = [](double x, double y) {
        return Eigen::AlignedBox2d(Eigen::Vector2d(x - 0.005, y - 0.005), Eigen::Vector2d(x + 0.005, y + 0.005));
    };
    EXPECT_TRUE(footprint.touches(around(0.41, -0.59)));
    EXPECT_TRUE(footprint.touches({Eigen::Vector2d(-1e9, -1e9), Eigen::Vector2d(1e9, 1e9)}));
    EXPECT_FALSE(footprint.touches(around(0, 0)));
    EXPECT_FALSE(footprint.touches(around(0.41, 0.59)));
    EXPECT_FALSE(footprint.touches(around(5, 5)));
}

}  // namespace
}  // namespace matchlight
