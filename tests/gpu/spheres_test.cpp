// Spheres on the GPU are where rays in double precision meet them, whatever is passed over on the way.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/Geometry>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/sphere_sets.h"
#include "render/surface.h"
#include "render/virtual_layer.h"
#include "render_scene.h"
#include "scene/sphere_caster.h"

namespace matchlight {
namespace {

using test::TestCamera;

class Spheres : public GlTest {
protected:
    static ShaderLibrary& shaders() {
        static ShaderLibrary library;
        return library;
    }
};

SphereSet set_of(std::vector<Sphere> spheres) {
    SphereSet set;
    set.name = "test";
    set.spheres = std::move(spheres);
    set.update_bounds();
    return set;
}

/// In a unit cube about the origin.
SphereSet random_set(std::size_t count, float least_radius, float most_radius) {
    std::mt19937_64 random(7);
    const auto uniform = [&] { return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53); };
    std::vector<Sphere> spheres(count);
    for (Sphere& sphere : spheres) {
        for (float& along : sphere.centre_m) along = uniform() - 0.5F;
        sphere.radius_m = least_radius + (most_radius - least_radius) * uniform();
    }
    return set_of(std::move(spheres));
}

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

}  // namespace
}  // namespace matchlight
