// Light between spheres by maps along the corners of an octahedron, against rays in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "gl_fixture.h"
#include "lighting/octahedral_directions.h"
#include "render/effects/object_shadow.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render_scene.h"
#include "report/sphere_reference.h"
#include "scene/sphere_caster.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

using test::random_set;
using test::set_of;
using test::TestCamera;

struct SphereOcclusionTest : GlTest {
    static ShaderLibrary& shaders() {
        static ShaderLibrary library;
        return library;
    }
    const Probe probe = test::uniform_probe(1);
    Environment environment{shaders(), probe};
    SurfaceRenderer surfaces{shaders()};
    TestCamera from{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 65, 75};

    static SurfaceObject white() {
        SurfaceObject object;
        object.material.diffuse = {1, 1, 1};
        object.material.specular = {0, 0, 0};
        return object;
    }
    ShadowCasters casters() {
        return {surfaces.shadow_caster_bounds_m(), [this](Program& p) { surfaces.draw_shadow_casters(p); },
                [this](const SphereCast& cast) { surfaces.cast_shadow_spheres(cast); }};
    }
    ImageF draw(const SurfaceShading& shading) {
        const SurfacePicture picture = surfaces.draw(environment, from.view(1), shading);
        return picture.color->read<float>({0, 0, from.size, from.size}, 4);
    }
    /// With meshes' vertices baked, too.
    ImageF draw_past(const ObjectShadow& shadow, bool pairs_maps) {
        Program& bake = shaders().compute("effects/object_shadow/bake.comp",
                                          pairs_maps ? ShaderDefines{{"PAIRED_MAPS", "1"}} : ShaderDefines{});
        bake.use();
        shadow.bind(bake, SurfaceShading::first_free_unit);
        surfaces.bake_visibility(bake);
        SurfaceShading shading;
        shading.pairs_maps = pairs_maps;
        shading.bind = [&shadow](Program& program) {
            program.set("objects_shade", true);
            shadow.bind(program, SurfaceShading::object_shadow_unit);
        };
        return draw(shading);
    }
    ImageF draw_with(int divisions, int resolution) {
        const ObjectShadow shadow(shaders(), casters(), sample_octahedrally(probe, divisions),
                                  {.resolution = resolution, .octahedron_divisions = divisions});
        EXPECT_EQ(shadow.directions(), octahedral_counts.at(static_cast<std::size_t>(divisions)));
        return draw_past(shadow, true);
    }
};

TEST_F(SphereOcclusionTest, a_map_of_both_sides_tells_what_one_of_each_does) {
    const Model box = test::make_sphere(0.3, 24);
    SurfaceObject mesh = white();
    mesh.model = &box;
    mesh.world_from_model = Eigen::Affine3d(Eigen::Translation3d(0, 0, -0.5)).matrix();
    surfaces.add_object(mesh);
    surfaces.add_spheres(white(), random_set(200, 0.05F, 0.12F));
    const ImageF paired = draw_with(2, 128);
    const ObjectShadow each(shaders(), casters(), sample_octahedrally(probe, 2), {.directions = 66, .resolution = 128});
    const ImageF of_each = draw_past(each, false);
    const ImageF open = draw({});
    int other = 0, shaded = 0;
    for (std::size_t i = 0; i < paired.samples().size(); ++i) {
        // Heights from the other side are rounded otherwise: a direction in 66 may be told otherwise by that.
        if (std::abs(paired.samples()[i] - of_each.samples()[i]) > 1e-3F) ++other;
        if (paired.samples()[i] < open.samples()[i] - 0.1F) ++shaded;
    }
    EXPECT_LT(other, 20);
    EXPECT_GT(shaded, 2000);
}

TEST_F(SphereOcclusionTest, comes_nearer_to_the_rays_with_every_division) {
    const SphereSet set = random_set(120, 0.08F, 0.16F);
    surfaces.add_spheres(white(), set);
    SphereCaster caster;
    caster.add_set(set);
    std::array<double, 4> errors{};
    for (int divisions = 0; divisions < 4; ++divisions) {
        const ImageF drawn = draw_with(divisions, 512);
        double sum = 0;
        int count = 0;
        for (int y = 0; y < from.size; y += 3) {
            for (int x = 0; x < from.size; x += 3) {
                const SphereRay ray{.origin_m = from.eye, .direction = from.ray(x, y), .least = 1e-3};
                const auto hit = caster.nearest(ray);
                if (!hit || drawn.at(x, y, 3) < 1) continue;
                const double expected = reference_open_share(caster, point_of(caster, ray, *hit), 32);
                sum += std::abs(drawn.at(x, y, 0) - expected);
                ++count;
            }
        }
        ASSERT_GT(count, 100);
        errors.at(static_cast<std::size_t>(divisions)) = sum / count;
    }
    RecordProperty("error_of_6", std::to_string(errors[0]));
    RecordProperty("error_of_258", std::to_string(errors[3]));
    EXPECT_LT(errors[1], errors[0]);
    EXPECT_LT(errors[2], errors[1]);
    EXPECT_LT(errors[3], errors[2]);
    // A hemisphere of 129 directions, each with its part of the 1/129 that its edge decides wrongly, and half a texel.
    EXPECT_LT(errors[3], 0.015);
}

TEST_F(SphereOcclusionTest, where_nothing_casts_it_changes_no_bit) {
    SurfaceObject object = white();
    object.casts_shadow = false;
    surfaces.add_spheres(object, random_set(50, 0.05F, 0.1F));
    const ImageF open = draw({});
    const ImageF drawn = draw_with(1, 64);
    EXPECT_TRUE(std::ranges::equal(open.samples(), drawn.samples()));
}

TEST_F(SphereOcclusionTest, a_sphere_alone_shades_itself_nowhere) {
    surfaces.add_spheres(white(), set_of({{{0, 0, 0}, 0.5F}}));
    const ImageF drawn = draw_with(3, 256);
    for (int y = 0; y < from.size; ++y) {
        for (int x = 0; x < from.size; ++x) {
            if (drawn.at(x, y, 3) <= 0) continue;
            EXPECT_NEAR(drawn.at(x, y, 0), 1, 1e-3) << x << ' ' << y;
        }
    }
}

}  // namespace
}  // namespace matchlight
