// Light that bounces against what theory says of it.
#include "render/effects/bounce_light.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render_scene.h"

namespace matchlight {
namespace {

class BounceLightTest : public GlTest {
protected:
    /// Irradiance over π at every vertex, by `settings`.
    std::vector<Eigen::Vector4f> bounced(const std::vector<SurfaceObject>& objects, const Probe& probe,
                                         const BounceLightSettings& settings) {
        SurfaceRenderer surfaces(shaders_);
        RayScene rays;
        std::vector<Eigen::Matrix4d> placements;
        for (const SurfaceObject& object : objects) {
            surfaces.add_object(object);
            rays.add_object(*object.model, object.material, false);
            placements.push_back(object.world_from_model);
        }
        rays.finish();
        rays.place(placements);
        const Environment environment(shaders_, probe);
        const BouncingObjects lit{.surfaces = surfaces, .rays = rays, .bind_light = [&](Program& program) {
                                      environment.bind(program);
                                      program.set("surface_z_m", probe_place_m_ ? 0.0 : -1e6);
                                      program.set("surface_shadow_present", 0);
                                      program.set("surface_is_near", probe_place_m_ ? 1 : 0);
                                      program.set("probe_place_m", probe_place_m_.value_or(Eigen::Vector3f::Zero()));
                                      program.set("surface_picture_texel_m", 0.0);
                                  }};
        bounce_between_objects(shaders_, lit, settings);
        std::vector<float> values(rays.vertex_count() * 4);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        rays.light().bounced.read(std::span(values));
        std::vector<Eigen::Vector4f> light;
        for (std::size_t i = 0; i < values.size(); i += 4) light.emplace_back(Eigen::Map<Eigen::Vector4f>(&values[i]));
        return light;
    }

    ShaderLibrary shaders_;
    std::optional<Eigen::Vector3f> probe_place_m_;  // over a surface at z = 0; else that is far away
};

SurfaceObject object_of(const Model& model, double albedo, double glow) {
    SurfaceObject object{.model = &model};
    object.material.base_color = {albedo, albedo, albedo};
    object.material.metallic = 0;
    object.material.roughness = 1;
    object.material.emissive = {glow, glow, glow};
    return object;
}

/// Irradiance over π on a point's plane from a parallel square of radiance 1 and side 2a, its middle at height h above
/// the point: four times a corner's form factor (Howell 2010, "A Catalog of Radiation Heat Transfer Configuration
/// Factors", B-3).
double square_overhead(double a, double h) {
    const double x = a / h;
    const double root = std::sqrt(1 + x * x);
    return 4 * (1 / (2 * std::numbers::pi)) * 2 * (x / root) * std::atan(x / root);
}

TEST_F(BounceLightTest, a_glowing_square_lights_what_lies_under_it) {
    const Model square = test::make_square(2), dot = test::make_square(0.01);
    for (const double height : {0.5, 1.0, 3.0}) {
        SurfaceObject lamp = object_of(square, 0, 1);
        lamp.world_from_model(2, 3) = height;
        const auto light = bounced({object_of(dot, 0.5, 0), lamp}, test::uniform_probe(0), {.rays = 1024});
        // A thousand directions divide the hemisphere to a thirtieth of its width.
        EXPECT_NEAR(light.front()[0], square_overhead(1, height), 0.01) << height;
    }
}

TEST_F(BounceLightTest, within_a_glowing_sphere_all_the_light_comes_back) {
    // From anywhere inside, every direction shows radiance g + albedo · (what arrives there) / 1: a geometric series.
    const Model dot = test::make_square(0.01);
    Model sphere = test::make_sphere(1, 24);
    test::turn_inside_out(sphere);
    constexpr double glow = 0.5, albedo = 0.6;
    const Probe dark = test::uniform_probe(0);
    SurfaceObject shell = object_of(sphere, albedo, glow);
    const SurfaceObject inside = object_of(dot, 0, 0);
    double last = 0;
    for (const int bounces : {1, 2, 8}) {
        const auto light = bounced({inside, shell}, dark, {.rays = 256, .bounces = bounces});
        const double arrives = light.front()[0];
        EXPECT_GT(arrives, last);
        last = arrives;
    }
    // The share that a dielectric's coat keeps from its diffuse part is small and the same at each bounce.
    EXPECT_NEAR(last, glow / (1 - albedo), 0.06);
}

TEST_F(BounceLightTest, alone_and_convex_nothing_bounces) {
    const Model sphere = test::make_sphere(1, 48);
    double most = 0;
    for (const Eigen::Vector4f& light :
         bounced({object_of(sphere, 1, 0)}, test::uniform_probe(1), {.rays = 64, .bounces = 2})) {
        most = std::max<double>(most, light[0]);
    }
    EXPECT_LT(most, 0.02);
}

/// The share of what a plate at height h sees, looking down, that lies on this side of an edge at the distance d: half
/// a plane's form factor (Howell 2010, "A Catalog of Radiation Heat Transfer Configuration Factors", B-1, its far side
/// at infinity).
double half_plane_below(double d, double h) {
    return 0.5 * (1 + d / std::hypot(d, h));
}

TEST_F(BounceLightTest, the_near_surface_lights_from_where_it_lies) {
    // A floor that is red on one side of x = 0 and green on the other, as a probe above that edge shows it.
    probe_place_m_ = {0, 0, 0.1F};
    const Probe halves = test::make_probe(256, [](const Eigen::Vector3d& direction) -> Eigen::Vector3d {
        if (direction.z() >= 0) return Eigen::Vector3d::Zero();
        return direction.x() < 0 ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(0, 1, 0);
    });
    const Model dot = test::make_square(1e-4);
    for (const double x : {-0.5, -0.1, 0.0, 0.05, 0.3}) {
        SurfaceObject plate = object_of(dot, 0.5, 0);
        plate.world_from_model.diagonal() << 1, -1, -1, 1;  // looks down
        plate.world_from_model.col(3) << x, 0, 0.08, 1;
        const Eigen::Vector4f more = bounced({plate}, halves, {.rays = 1024, .bounces = 1}).front();
        // From far away half of all is red. Rays of a 32nd of the hemisphere's width blur the edge.
        EXPECT_NEAR(more[0], half_plane_below(-x, 0.08) - 0.5, 0.02) << x;
        EXPECT_NEAR(more[1], half_plane_below(x, 0.08) - 0.5, 0.02) << x;
        EXPECT_NEAR(more[2], 0, 1e-5) << x;
    }
}

}  // namespace
}  // namespace matchlight
