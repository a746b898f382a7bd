// Spheres on the GPU are where rays in double precision meet them, whatever is passed over on the way.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

#include "gl_fixture.h"
#include "render/effects/contact_shadow.h"
#include "render/environment.h"
#include "render/sphere_sets.h"
#include "render/surface.h"
#include "render_scene.h"
#include "scene/sphere_caster.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

using test::glowing;
using test::random_set;
using test::set_of;
using test::TestCamera;

class Spheres : public GlTest {
protected:
    static ShaderLibrary& shaders() {
        static ShaderLibrary library;
        return library;
    }
};

const TestCamera camera{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 257, 300};

struct Picture {
    Image<std::uint32_t> id;
    ImageF depth_share;
};

Picture read(const SeenSpheres& seen, int size) {
    const Region region{0, 0, size, size};
    return {seen.id->read<std::uint32_t>(region, 1), seen.depth_share->read<float>(region, 1)};
}

Picture see(SphereSets& sets, const TestCamera& from,
            const Eigen::Matrix4d& world_from_model = Eigen::Matrix4d::Identity()) {
    const PlacedSpheres placed{
        .set = 0, .world_from_model = world_from_model, .clip_from_world = from.view().clip_from_world};
    return read(sets.see(std::span(&placed, 1), from.size, from.size), from.size);
}

TEST_F(Spheres, one_has_the_silhouette_and_the_depth_of_a_sphere_in_perspective) {
    const double radius = 0.5;
    SphereSets sets(shaders());
    sets.add(set_of({{{0, 0, 0}, static_cast<float>(radius)}}));
    // Away from the axis a sphere's outline is an ellipse.
    const TestCamera from{{0.7, -1.5, 0.4}, {0, 1, 0}, {1, 0, 0}, 257, 120};
    const Picture seen = see(sets, from);
    int inside = 0;
    for (int y = 0; y < from.size; ++y) {
        for (int x = 0; x < from.size; ++x) {
            const Eigen::Vector3d ray = from.ray(x, y);
            const auto hit = test::hit_sphere(from.eye, ray, radius);
            ASSERT_EQ(hit.has_value(), seen.id.at(x, y, 0) != 0) << x << ", " << y;
            if (!hit) continue;
            ++inside;
            const double z_m = (*hit - from.eye).dot(from.forward);
            // At the rim the depth goes with the root of what is left of the radius.
            const double rim = std::abs((*hit).normalized().dot(ray));
            EXPECT_NEAR(1e-3 / seen.depth_share.at(x, y, 0), z_m, 1e-6 / rim) << x << ", " << y;
        }
    }
    EXPECT_GT(inside, 2000);
}

TEST_F(Spheres, what_is_passed_over_changes_no_pixel) {
    SphereSets sets(shaders());
    sets.add(random_set(150'000, 0.004F, 0.012F));
    for (const TestCamera& from : {camera, TestCamera{{0.1, -0.2, 0.1}, {0, 1, 0}, {1, 0, 0}, 257, 200}}) {
        sets.visibility = {.frustum = false, .occlusion = false};
        const Picture all = see(sets, from);
        const std::size_t all_cells = sets.culling().cells_drawn();
        sets.visibility = {.frustum = true, .occlusion = true};
        const Picture tested = see(sets, from);
        EXPECT_LT(sets.culling().cells_drawn(), all_cells * 3 / 4);
        EXPECT_TRUE(std::ranges::equal(all.id.samples(), tested.id.samples()));
        EXPECT_TRUE(std::ranges::equal(all.depth_share.samples(), tested.depth_share.samples()));
    }
}

TEST_F(Spheres, many_are_where_rays_in_double_precision_meet_them) {
    const SphereSet set = random_set(3000, 0.01F, 0.06F);
    SphereSets sets(shaders());
    sets.add(set);
    SphereCaster caster;
    caster.add_set(set);
    const Picture seen = see(sets, camera);
    int different = 0, covered = 0;
    for (int y = 0; y < camera.size; ++y) {
        for (int x = 0; x < camera.size; ++x) {
            const Eigen::Vector3d ray = camera.ray(x, y);
            const double forward = ray.dot(camera.forward);
            const auto hit = caster.nearest({.origin_m = camera.eye, .direction = ray, .least = 1e-3 / forward});
            const bool is_seen = seen.id.at(x, y, 0) != 0;
            if (hit) ++covered;
            if (hit.has_value() != is_seen) {
                ++different;
                continue;
            }
            if (!hit) continue;
            // Where a ray grazes a sphere, it may meet or miss it by rounding.
            if (std::abs(1e-3 / seen.depth_share.at(x, y, 0) - hit->distance * forward) > 1e-4) ++different;
        }
    }
    EXPECT_GT(covered, 10'000);
    EXPECT_LE(different, 2);
}

TEST_F(Spheres, from_radii_of_a_millionth_to_a_million_of_the_distance) {
    for (const double radius : {1e-3, 1.0, 1e3, 1e6}) {
        // Before the eye, one metre away.
        SphereSets sets(shaders());
        sets.add(set_of({{{0, static_cast<float>(radius), 0}, static_cast<float>(radius)}}));
        const TestCamera from{{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, 65, 100};
        const Picture seen = see(sets, from);
        const int middle = from.size / 2;
        ASSERT_NE(seen.id.at(middle, middle, 0), 0U) << radius;
        EXPECT_NEAR(1e-3 / seen.depth_share.at(middle, middle, 0), 1, 1e-5) << radius;
    }
    // A micrometre a metre away covers no pixel's middle but the one that it is put in.
    SphereSets sets(shaders());
    sets.add(set_of({{{0, 0, 0}, 1e-6F}}));
    const TestCamera from{{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, 65, 100};
    const Picture seen = see(sets, from);
    EXPECT_EQ(std::ranges::count_if(seen.id.samples(), [](std::uint32_t id) { return id != 0; }), 1);
    EXPECT_NE(seen.id.at(32, 32, 0), 0U);
}

TEST_F(Spheres, from_inside_the_far_side_is_seen) {
    SphereSets sets(shaders());
    sets.add(set_of({{{0, 0, 0}, 2}}));
    const TestCamera from{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 65, 30};
    const Picture seen = see(sets, from);
    for (int y = 0; y < from.size; ++y) {
        for (int x = 0; x < from.size; ++x) {
            ASSERT_NE(seen.id.at(x, y, 0), 0U);
            EXPECT_NEAR(1e-3 / seen.depth_share.at(x, y, 0), 2 * from.ray(x, y).y(), 1e-5);
        }
    }
}

TEST_F(Spheres, of_those_at_one_place_the_first_is_seen) {
    SphereSets sets(shaders());
    const Sphere one{{0, 0, 0}, 0.3F};
    sets.add(set_of({one, one, one}));
    const Picture seen = see(sets, camera);
    EXPECT_EQ(std::ranges::max(seen.id.samples()), sets.first_id(0));
}

TEST_F(Spheres, one_is_lit_as_a_mesh_of_it_is) {
    const Probe probe = test::make_probe(128, [](const Eigen::Vector3d& d) { return test::octant_color(d); });
    const Environment environment(shaders(), probe);
    const TestCamera from{{0, -2, 0.4}, {0, 1, 0}, {1, 0, 0}, 129, 160};
    Model mesh = test::make_sphere(0.5);
    MaterialOverride material;
    material.base_color = {0.8, 0.5, 0.2};
    material.roughness = 0.6;
    SurfaceRenderer meshes(shaders()), spheres(shaders());
    meshes.add_object({.model = &mesh, .material = material});
    spheres.add_spheres({.material = material}, set_of({{{0, 0, 0}, 0.5F}}));
    const SurfacePicture of_mesh = meshes.draw(environment, from.view(1));
    const ImageF expected = of_mesh.color->read<float>({0, 0, from.size, from.size}, 4);
    const SurfacePicture of_sphere = spheres.draw(environment, from.view(1));
    const ImageF drawn = of_sphere.color->read<float>({0, 0, from.size, from.size}, 4);
    int compared = 0;
    for (int y = 0; y < from.size; ++y) {
        for (int x = 0; x < from.size; ++x) {
            const auto hit = test::hit_sphere(from.eye, from.ray(x, y), 0.5);
            // Towards the rim the mesh's normals are those of its triangles.
            if (!hit || std::abs(hit->normalized().dot(from.ray(x, y))) < 0.3) continue;
            ++compared;
            for (int c = 0; c < 4; ++c) ASSERT_NEAR(drawn.at(x, y, c), expected.at(x, y, c), 4e-3) << x << ", " << y;
        }
    }
    EXPECT_GT(compared, 3000);
}

TEST_F(Spheres, layers_and_ways_are_those_of_a_mesh) {
    Model mesh = test::make_sphere(0.5);
    SurfaceRenderer meshes(shaders()), spheres(shaders());
    meshes.add_object({.model = &mesh, .id = 3});
    spheres.add_spheres({.id = 3}, set_of({{{0, 0, 0}, 0.5F}}));
    const SurfaceView view = camera.view(1);
    const Region region{0, 0, camera.size, camera.size};
    const SurfacePicture of_mesh = meshes.draw_layers(view), of_sphere = spheres.draw_layers(view);
    const ImageF mesh_depth = of_mesh.depth_m->read<float>(region, 1),
                 depth = of_sphere.depth_m->read<float>(region, 1);
    const ImageF mesh_normal = of_mesh.normal->read<float>(region, 4),
                 normal = of_sphere.normal->read<float>(region, 4);
    ObjectWay way;
    way.closing_camera_from_model.topRightCorner<3, 1>() = Eigen::Vector3d(0.1, 0, 2);
    way.opening_camera_from_model.topRightCorner<3, 1>() = Eigen::Vector3d(0, 0, 2);
    const ImageF mesh_way = meshes.draw_ways(view, std::span(&way, 1)).read<float>(region, 4);
    const ImageF sphere_way = spheres.draw_ways(view, std::span(&way, 1)).read<float>(region, 4);
    int compared = 0;
    for (int y = 0; y < camera.size; ++y) {
        for (int x = 0; x < camera.size; ++x) {
            const auto hit = test::hit_sphere(camera.eye, camera.ray(x, y), 0.5);
            if (!hit || std::abs(hit->normalized().dot(camera.ray(x, y))) < 0.3) continue;
            ++compared;
            ASSERT_NEAR(depth.at(x, y, 0), mesh_depth.at(x, y, 0), 1e-3);
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(normal.at(x, y, c), mesh_normal.at(x, y, c), 2e-3);
                ASSERT_NEAR(sphere_way.at(x, y, c), mesh_way.at(x, y, c), 1e-3);
            }
        }
    }
    EXPECT_GT(compared, 10'000);
}

TEST_F(Spheres, shade_the_surface_and_each_other_as_meshes_do) {
    Model mesh = test::make_sphere(0.5);
    SurfaceRenderer meshes(shaders()), spheres(shaders());
    const Eigen::Matrix4d raised = Eigen::Affine3d(Eigen::Translation3d(0, 0, 0.8)).matrix();
    meshes.add_object({.model = &mesh, .world_from_model = raised});
    spheres.add_spheres({.world_from_model = raised}, set_of({{{0, 0, 0}, 0.5F}}));
    const SurfaceLight light = make_surface_light(test::uniform_probe(1), 0, 16);
    const ContactShadowSettings settings{.directions = 16, .resolution = 128};
    const ShadowCasters of_mesh{meshes.shadow_caster_bounds_m(), [&](Program& p) { meshes.draw_shadow_casters(p); }};
    const ShadowCasters of_sphere{spheres.shadow_caster_bounds_m(), [&](Program& p) { spheres.draw_shadow_casters(p); },
                                  [&](const SphereCast& cast) { spheres.cast_shadow_spheres(cast); }};
    ASSERT_TRUE(of_sphere.bounds_m.isApprox(of_mesh.bounds_m, 1e-6));
    const auto expected = make_contact_shadow(shaders(), of_mesh, light, settings);
    const auto cast = make_contact_shadow(shaders(), of_sphere, light, settings);
    ASSERT_TRUE(expected && cast);
    const ImageF expected_loss = expected->fine.loss.read<float>(expected->fine.loss.bounds(), 4);
    const ImageF loss = cast->fine.loss.read<float>(cast->fine.loss.bounds(), 4);
    double most = 0, difference = 0;
    for (std::size_t i = 0; i < loss.samples().size(); ++i) {
        most = std::max(most, double(expected_loss.samples()[i]));
        difference += std::abs(loss.samples()[i] - expected_loss.samples()[i]);
    }
    EXPECT_GT(most, 0.2);
    // Texels at the outlines of some directions.
    EXPECT_LT(difference / static_cast<double>(loss.samples().size()), 0.002 * most);
}

TEST_F(Spheres, what_maps_of_shadow_pass_over_changes_no_texel) {
    SurfaceRenderer surfaces(shaders());
    surfaces.add_spheres({}, random_set(150'000, 0.01F, 0.02F));
    const int size = 128;
    const Texture2D depth({.format = GL_DEPTH_COMPONENT32F, .width = size, .height = size});
    const Framebuffer target({}, Attachment(depth));
    SphereProjection view{.width = size, .height = size, .is_parallel = true};
    view.clip_from_world = Eigen::Affine3d(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0.5).normalized())).matrix();
    view.clip_from_world.row(2) *= 0.25;  // depth within 0..1
    view.clip_from_world(2, 3) = 0.5;
    std::array<ImageF, 2> maps;
    std::array<std::size_t, 2> cells{};
    for (const std::size_t tests : {0U, 1U}) {
        surfaces.spheres()->visibility = {.frustum = tests != 0, .occlusion = tests != 0};
        target.bind();
        target.clear_depth();
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_GREATER);
        surfaces.cast_shadow_spheres({.view = view, .fragment = "spheres/depth.frag", .set_up = {}, .depth = &depth});
        glDisable(GL_DEPTH_TEST);
        maps.at(tests) = depth.read<float>(depth.bounds(), 1);
        cells.at(tests) = surfaces.spheres()->culling().cells_drawn();
    }
    EXPECT_LT(cells[1], cells[0]);
    EXPECT_TRUE(std::ranges::equal(maps[0].samples(), maps[1].samples()));
    EXPECT_GT(*std::ranges::max_element(maps[0].samples()), 0.5F);
}

struct PeelingTest : Spheres {
    Environment environment{shaders(), test::uniform_probe(1)};
    SurfaceRenderer surfaces{shaders()};
    TestCamera from{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 65, 75};

    ImageF draw() {
        const SurfacePicture picture = surfaces.draw(environment, from.view(1));
        return picture.color->read<float>({0, 0, from.size, from.size}, 4);
    }
};

TEST_F(PeelingTest, lists_show_what_peeling_shows) {
    from.size = 33;
    from.focal_px = 40;
    SphereSet set = random_set(600, 0.03F, 0.15F);
    set.opacity = 0.2F;
    // Some at one place.
    for (std::size_t i = 0; i < 100; ++i) set.spheres[i] = set.spheres[i + 100];
    Model mesh = test::make_sphere(0.3);
    surfaces.add_object({.model = &mesh, .material = glowing({0, 1, 0}), .id = 1});
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2}), .id = 2}, set);
    for (const double residual : {1e-4, 0.1}) {
        surfaces.set_peeling(residual, 1000, TransparencyMethod::peeling);
        const ImageF peeled = draw();
        const int layers = surfaces.peeled_layers();
        // All rows at once, a few at a time, and rows that no buffer holds.
        for (const std::uint32_t most : {0U, 2000U, 10U}) {
            surfaces.sphere_lists().limit_entries(most);
            surfaces.set_peeling(residual, 1000, TransparencyMethod::lists);
            const ImageF listed = draw();
            EXPECT_TRUE(std::ranges::equal(peeled.samples(), listed.samples())) << residual << ", " << most;
            EXPECT_LE(surfaces.peeled_layers(), layers);
        }
    }
}

TEST_F(PeelingTest, lists_show_what_peeling_shows_where_cells_are_passed_over) {
    from.size = 33;
    from.focal_px = 40;
    SphereSet set = random_set(150'000, 0.004F, 0.012F);
    set.opacity = 0.5F;
    Model mesh = test::make_sphere(0.4);
    surfaces.add_object({.model = &mesh, .material = glowing({0, 1, 0}), .id = 1});
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2}), .id = 2}, set);
    surfaces.set_peeling(0.01, 12, TransparencyMethod::peeling);
    const ImageF peeled = draw();
    surfaces.set_peeling(0.01, 12, TransparencyMethod::lists);
    EXPECT_TRUE(std::ranges::equal(peeled.samples(), draw().samples()));
}

TEST_F(PeelingTest, both_ends_at_once_show_what_the_front_shows) {
    from.size = 33;
    from.focal_px = 40;
    SphereSet set = random_set(600, 0.03F, 0.15F);
    set.opacity = 0.2F;
    // Some at one place: two, and four.
    for (std::size_t i = 0; i < 100; ++i) set.spheres[i] = set.spheres[i + 100];
    for (std::size_t i = 100; i < 120; ++i) set.spheres[i + 200] = set.spheres[i + 220] = set.spheres[i];
    Model mesh = test::make_sphere(0.3);
    for (const bool has_mesh : {false, true}) {
        if (has_mesh) {
            surfaces.add_object({.model = &mesh, .material = glowing({0, 1, 0}), .id = 1});
        } else {
            surfaces.add_spheres({.material = glowing({1, 0.5, 0.2}), .id = 2}, set);
        }
        surfaces.set_peeling(1e-6, 1000, TransparencyMethod::lists);
        const ImageF listed = draw();
        const int layers = surfaces.peeled_layers();
        surfaces.set_peeling(1e-6, 1000, TransparencyMethod::dual_peeling);
        const ImageF dual = draw();
        EXPECT_GT(layers, 20);
        EXPECT_NEAR(surfaces.peeled_layers(), layers, 8);
        for (std::size_t i = 0; i < dual.samples().size(); ++i) {
            // The picture is of half floats; sums from the other end differ by less.
            ASSERT_NEAR(dual.samples()[i], listed.samples()[i], 1e-3) << i;
        }
        // What is stopped lets no more through than was allowed, under light of 1 and less.
        const double residual = 0.1;
        surfaces.set_peeling(residual, 1000, TransparencyMethod::dual_peeling);
        const ImageF stopped = draw();
        EXPECT_LT(surfaces.peeled_layers(), layers);
        for (std::size_t i = 0; i < dual.samples().size(); ++i)
            ASSERT_NEAR(stopped.samples()[i], listed.samples()[i], residual + 1e-3) << i;
    }
}

TEST_F(PeelingTest, both_ends_at_once_show_the_same_where_cells_are_passed_over) {
    from.size = 33;
    from.focal_px = 40;
    SphereSet set = random_set(150'000, 0.004F, 0.012F);
    set.opacity = 0.5F;
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2}), .id = 2}, set);
    surfaces.set_peeling(0.001, 1000, TransparencyMethod::dual_peeling);
    const ImageF dual = draw();
    surfaces.spheres()->visibility = {.frustum = false, .occlusion = false};
    EXPECT_TRUE(std::ranges::equal(dual.samples(), draw().samples()));
    surfaces.set_peeling(0.001, 1000, TransparencyMethod::lists);
    const ImageF listed = draw();
    for (std::size_t i = 0; i < dual.samples().size(); ++i) ASSERT_NEAR(dual.samples()[i], listed.samples()[i], 2e-3);
}

TEST_F(PeelingTest, layers_add_up_in_the_order_of_the_ray) {
    const std::array<std::array<double, 3>, 2> lights{{{1, 0.2, 0}, {0, 0.3, 0.8}}};
    std::array<SphereSet, 2> sets{random_set(150, 0.05F, 0.15F), random_set(200, 0.03F, 0.12F)};
    for (std::size_t i = 0; i < sets[1].size(); ++i) sets[1].spheres[i].centre_m[0] += 0.031F;
    sets[0].opacity = 0.3F;
    for (std::size_t i = 0; i < sets[1].size(); ++i) sets[1].opacities.push_back(static_cast<float>(i % 11) / 10.F);
    SphereCaster caster;
    for (std::size_t i = 0; i < 2; ++i) {
        sets[i].update_bounds();
        surfaces.add_spheres({.material = glowing(lights[i]), .id = static_cast<int>(i) + 1}, sets[i]);
        caster.add_set(sets[i]);
    }
    for (const double residual : {1e-4, 0.1}) {
        surfaces.set_peeling(residual, 1000);
        const ImageF drawn = draw();
        std::vector<SphereHit> hits;
        int different = 0;
        double most = 0;
        for (int y = 0; y < from.size; ++y) {
            for (int x = 0; x < from.size; ++x) {
                caster.all({.origin_m = from.eye, .direction = from.ray(x, y), .least = 1e-3},
                           SphereCaster::Surfaces::first, hits);
                Eigen::Vector3d light = Eigen::Vector3d::Zero();
                double through = 1;
                for (const SphereHit& hit : hits) {
                    const SphereSet& set = sets[hit.set];
                    const double opacity = set.opacities.empty() ? set.opacity : set.opacities[hit.sphere];
                    light += through * opacity * Eigen::Vector3d(lights[hit.set].data());
                    through *= 1 - opacity;
                }
                // A half float's step besides what is let through.
                const double bound = residual + 1e-3;
                bool is_off = std::abs(drawn.at(x, y, 3) - (1 - through)) > bound;
                for (int c = 0; c < 3; ++c) is_off = is_off || std::abs(drawn.at(x, y, c) - light[c]) > bound;
                if (is_off) ++different;
                most = std::max(most, 1 - through);
            }
        }
        EXPECT_GT(most, 0.99);
        // Where a ray grazes a sphere, it may meet or miss it by rounding.
        EXPECT_LE(different, 2) << residual;
    }
}

TEST_F(PeelingTest, what_is_passed_over_changes_no_pixel) {
    SphereSet set = random_set(150'000, 0.004F, 0.012F);
    set.opacity = 0.5F;
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2})}, set);
    surfaces.set_peeling(0.01, 12, TransparencyMethod::peeling);
    surfaces.spheres()->visibility = {.frustum = false, .occlusion = false};
    const ImageF all = draw();
    const std::size_t all_cells = surfaces.spheres()->culling().cells_drawn();
    surfaces.spheres()->visibility = {.frustum = true, .occlusion = true};
    const ImageF tested = draw();
    EXPECT_LT(surfaces.spheres()->culling().cells_drawn(), all_cells);
    EXPECT_TRUE(std::ranges::equal(all.samples(), tested.samples()));
    EXPECT_GT(all.at(32, 32, 3), 0.98F);
}

TEST_F(PeelingTest, fewer_layers_where_more_may_be_let_through) {
    SphereSet set = random_set(400, 0.1F, 0.2F);
    set.opacity = 0.5F;
    surfaces.add_spheres({.material = glowing({1, 1, 1})}, set);
    surfaces.set_peeling(1e-4, 1000);
    draw();
    const int many = surfaces.peeled_layers();
    surfaces.set_peeling(0.1, 1000);
    draw();
    EXPECT_LT(surfaces.peeled_layers(), many);
}

TEST_F(PeelingTest, those_at_one_place_are_all_counted) {
    const Sphere one{{0.1F, 0, 0.3F}, 0.3F};
    SphereSet set = set_of({one, one, one});
    set.opacity = 0.5F;
    surfaces.add_spheres({.material = glowing({1, 1, 1})}, set);
    const ImageF drawn = draw();
    EXPECT_NEAR(drawn.at(32, 32, 3), 0.875, 1e-3);
}

TEST_F(PeelingTest, what_is_opaque_hides_them_and_shows_through_them) {
    SphereSet set = set_of({{{0, -0.8F, 0.2F}, 0.1F}, {{0, 0.8F, -0.1F}, 0.1F}});
    set.opacity = 0.25F;
    Model mesh = test::make_sphere(0.5);
    surfaces.add_object({.model = &mesh, .material = glowing({0, 1, 0}), .id = 1});
    surfaces.add_spheres({.material = glowing({1, 0, 0}), .id = 2}, set);
    const ImageF drawn = draw();
    int before = 0;
    for (int y = 0; y < from.size; ++y) {
        for (int x = 0; x < from.size; ++x) {
            if (!test::hit_sphere(from.eye, from.ray(x, y), 0.49)) continue;
            const bool is_before = drawn.at(x, y, 0) > 0;
            if (is_before) ++before;
            ASSERT_NEAR(drawn.at(x, y, 0), is_before ? 0.25 : 0, 1e-3);
            ASSERT_NEAR(drawn.at(x, y, 1), is_before ? 0.75 : 1, 1e-3);
        }
    }
    EXPECT_GT(before, 20);
}

TEST_F(PeelingTest, sets_without_a_sphere_that_blends_peel_nothing) {
    SphereSet set = random_set(100, 0.05F, 0.1F);
    surfaces.add_spheres({.material = glowing({1, 1, 1})}, set);
    draw();
    EXPECT_EQ(surfaces.peeled_layers(), 0);
}

}  // namespace
}  // namespace matchlight
