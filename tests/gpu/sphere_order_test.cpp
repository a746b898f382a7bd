// Blended meshes and transparent spheres in the order of each pixel's ray, against the exact composite.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render_scene.h"
#include "report/transparency_reference.h"
#include "scene/sphere_caster.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using test::glowing;
using test::set_of;
using test::TestCamera;

constexpr double plane_side_m = 1.6;

/// A square that lets light through, about the origin.
struct Plane {
    Eigen::Affine3d world_from_model;
    std::array<double, 3> light;
    float opacity;
};

struct SphereOrderTest : GlTest {
    static ShaderLibrary& shaders() {
        static ShaderLibrary library;
        return library;
    }
    Environment environment{shaders(), test::uniform_probe(1)};
    SurfaceRenderer surfaces{shaders()};
    TestCamera from{{0.1, -2.5, 0.3}, {0, 1, 0}, {1, 0, 0}, 97, 100};
    // They cross along a line before the camera, and stand behind each other beside it.
    const std::array<Plane, 2> planes{
        {{Eigen::Affine3d(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * Eigen::AngleAxisd(1.4, Vector3d::UnitX())),
          {1, 0.1, 0.1},
          0.5F},
         {Eigen::Affine3d(Eigen::AngleAxisd(-0.6, Vector3d::UnitZ()) * Eigen::AngleAxisd(1.7, Vector3d::UnitX())),
          {0.1, 0.2, 1},
          0.7F}}};

    void add(const Plane& plane) {
        Model model = test::make_square(plane_side_m);
        model.materials.front().alpha_mode = AlphaMode::blend;
        model.materials.front().double_sided = true;
        model.materials.front().base_color[3] = plane.opacity;
        surfaces.add_object(
            {.model = &model, .world_from_model = plane.world_from_model.matrix(), .material = glowing(plane.light)});
    }
    ImageF draw() {
        const SurfacePicture picture = surfaces.draw(environment, from.view(1));
        return picture.color->read<float>({0, 0, from.size, from.size}, 4);
    }
    std::optional<TransparentLayer> layer_of(const Plane& plane, const Vector3d& ray) const {
        const Eigen::Affine3d model_from_world = plane.world_from_model.inverse();
        const Vector3d eye = model_from_world * from.eye, along = model_from_world.linear() * ray;
        const double distance = -eye.z() / along.z();
        const Vector3d met = eye + distance * along;
        if (distance <= 0 || met.head<2>().cwiseAbs().maxCoeff() > plane_side_m / 2) return std::nullopt;
        return TransparentLayer{Vector3d(plane.light.data()), double(plane.opacity), distance};
    }
    /// Pixels that are off by more than half floats are, of all.
    int off(const ImageF& drawn, const SphereCaster& caster, const Vector3d& sphere_light) const {
        int count = 0;
        for (int y = 0; y < from.size; ++y) {
            for (int x = 0; x < from.size; ++x) {
                const Vector3d ray = from.ray(x, y);
                std::vector<SphereHit> hits;
                caster.all({.origin_m = from.eye, .direction = ray, .least = 1e-3}, SphereCaster::Surfaces::first,
                           hits);
                std::vector<TransparentLayer> layers;
                for (const SphereHit& hit : hits)
                    layers.push_back({sphere_light, double(caster.set(hit.set).opacity), hit.distance});
                for (const Plane& plane : planes) {
                    if (const auto layer = layer_of(plane, ray)) layers.push_back(*layer);
                }
                std::ranges::sort(layers, {}, &TransparentLayer::depth_m);
                const Vector3d exact = composite_in_order(layers, Vector3d::Zero());
                double error = 0;
                for (int c = 0; c < 3; ++c) error = std::max(error, std::abs(drawn.at(x, y, c) - exact[c]));
                count += error > 2e-3 ? 1 : 0;
            }
        }
        return count;
    }
};

/// At outlines, a ray may meet or miss by rounding.
constexpr int most_grazing = 6;

TEST_F(SphereOrderTest, crossing_planes_with_spheres_between_them) {
    for (const Plane& plane : planes) add(plane);
    const Vector3d light(0.2, 1, 0.1);
    // Before, between, behind and through them.
    SphereSet set =
        set_of({{{0, -0.4F, 0}, 0.2F}, {{0.4F, 0, 0.1F}, 0.15F}, {{0, 0.5F, 0.2F}, 0.3F}, {{0, 0, 0}, 0.35F}});
    set.opacity = 0.4F;
    surfaces.add_spheres({.material = glowing({light[0], light[1], light[2]}), .id = 2}, set);
    SphereCaster caster;
    caster.add_set(set);
    const ImageF listed = draw();
    EXPECT_LE(off(listed, caster, light), most_grazing);
    // A few rows at a time are the same.
    surfaces.sphere_lists().limit_entries(5000);
    EXPECT_TRUE(std::ranges::equal(listed.samples(), draw().samples()));
    // In the order of their middles, and before the spheres, they are not right.
    surfaces.set_peeling(1e-5, 1000, TransparencyMethod::peeling);
    EXPECT_GT(off(draw(), caster, light), 500);
}

TEST_F(SphereOrderTest, crossing_planes_alone) {
    for (const Plane& plane : planes) add(plane);
    EXPECT_LE(off(draw(), {}, Vector3d::Zero()), most_grazing);
    surfaces.set_peeling(1e-5, 1000, TransparencyMethod::peeling);
    EXPECT_GT(off(draw(), {}, Vector3d::Zero()), 500);
}

TEST_F(SphereOrderTest, rows_that_no_list_holds_show_meshes_in_their_own_order) {
    add(planes[0]);
    Plane apart = planes[0];
    apart.world_from_model.pretranslate(Vector3d(0.05, 0.1, 0));
    add(apart);
    const ImageF listed = draw();
    surfaces.sphere_lists().limit_entries(1);
    const ImageF own = draw();
    for (std::size_t i = 0; i < own.samples().size(); ++i) ASSERT_NEAR(own.samples()[i], listed.samples()[i], 2e-3);
}

TEST_F(SphereOrderTest, where_no_two_meet_no_bit_changes) {
    add(planes[0]);
    const ImageF listed = draw();
    surfaces.set_peeling(1e-5, 1000, TransparencyMethod::peeling);
    EXPECT_TRUE(std::ranges::equal(listed.samples(), draw().samples()));
}

}  // namespace
}  // namespace matchlight
