// Transparent spheres without an order: what the sums are in double precision, and how far off the exact composite.
#include "render/sphere_blending.h"

#include <algorithm>
#include <array>
#include <cmath>
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
using test::random_set;
using test::set_of;
using test::TestCamera;

constexpr std::array every_method{
    TransparencyMethod::lists,        TransparencyMethod::peeling,          TransparencyMethod::dual_peeling,
    TransparencyMethod::weighted_sum, TransparencyMethod::weighted_blended, TransparencyMethod::moments};
constexpr std::array without_order{TransparencyMethod::weighted_sum, TransparencyMethod::weighted_blended,
                                   TransparencyMethod::moments};
/// The picture is of half floats.
constexpr double half_step = 1e-3;

struct SphereBlendingTest : GlTest {
    static ShaderLibrary& shaders() {
        static ShaderLibrary library;
        return library;
    }
    Environment environment{shaders(), test::uniform_probe(1)};
    SurfaceRenderer surfaces{shaders()};
    TestCamera from{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 65, 75};

    ImageF draw(TransparencyMethod method) {
        surfaces.set_peeling(1e-5, 1000, method);
        const SurfacePicture picture = surfaces.draw(environment, from.view(1));
        return picture.color->read<float>({0, 0, from.size, from.size}, 4);
    }
};

/// Two sets that glow, so that what is seen does not hang on the light, and their layers along each ray.
struct TwoSetsTest : SphereBlendingTest {
    const std::array<std::array<double, 3>, 2> lights{{{1, 0.2, 0}, {0, 0.3, 0.8}}};
    std::array<SphereSet, 2> sets{random_set(150, 0.05F, 0.15F), random_set(200, 0.03F, 0.12F)};
    SphereCaster caster;

    void add(float opacity) {
        for (Sphere& sphere : sets[1].spheres) sphere.centre_m[0] += 0.031F;
        for (std::size_t i = 0; i < 2; ++i) {
            sets.at(i).opacity = opacity;
            sets.at(i).update_bounds();
            surfaces.add_spheres({.material = glowing(lights.at(i)), .id = static_cast<int>(i) + 1}, sets.at(i));
            caster.add_set(sets.at(i));
        }
    }
    std::vector<TransparentLayer> layers(int x, int y) const {
        const Vector3d ray = from.ray(x, y);
        std::vector<SphereHit> hits;
        caster.all({.origin_m = from.eye, .direction = ray, .least = 1e-3}, SphereCaster::Surfaces::first, hits);
        std::vector<TransparentLayer> found;
        for (const SphereHit& hit : hits) {
            found.push_back({Vector3d(lights.at(hit.set).data()), double(sets.at(hit.set).opacity),
                             hit.distance * ray.dot(from.forward)});
        }
        return found;
    }
    /// Pixels that are off what `expected` makes of their layers, light and then what is covered; and the mean error.
    template <class Expected>
    std::pair<int, double> compared(const ImageF& drawn, double bound, const Expected& expected) const {
        int off = 0;
        double sum = 0;
        for (int y = 0; y < from.size; ++y) {
            for (int x = 0; x < from.size; ++x) {
                const Eigen::Vector4d exact = expected(layers(x, y));
                double error = 0;
                for (int c = 0; c < 4; ++c) error = std::max(error, std::abs(drawn.at(x, y, c) - exact[c]));
                if (error > bound) ++off;
                sum += error;
            }
        }
        return {off, sum / (from.size * from.size)};
    }
};

/// Light over black, and what is covered by the light that white behind it adds.
template <class Method>
Eigen::Vector4d light_and_cover(const Method& method) {
    const Vector3d over_black = method(Vector3d::Zero());
    Eigen::Vector4d sum;
    sum << over_black, 1 - (method(Vector3d::Ones()) - over_black).x();
    return sum;
}

Eigen::Vector4d exact(const std::vector<TransparentLayer>& layers) {
    return light_and_cover([&](const Vector3d& behind) { return composite_in_order(layers, behind); });
}

// Where a ray grazes a sphere, it may meet or miss it by rounding.
constexpr int most_grazing = 4;

TEST_F(SphereBlendingTest, one_layer_is_exact_by_every_method) {
    const Model wall = test::make_sphere(0.5);
    SphereSet set = set_of({{{0.05F, -0.8F, 0.1F}, 0.12F}, {{0, 0.9F, -0.1F}, 0.2F}});
    for (const float opacity : {0.0F, 0.3F}) {
        set.opacity = opacity;
        SurfaceRenderer with_set(shaders());
        with_set.add_object({.model = &wall, .material = glowing({0.2, 0.8, 0.5}), .id = 1});
        with_set.add_spheres({.material = glowing({2, 0.5, 0.1}), .id = 2}, set);
        const Vector3d light(2, 0.5, 0.1), behind(0.2, 0.8, 0.5);
        for (const TransparencyMethod method : every_method) {
            with_set.set_peeling(1e-5, 1000, method);
            const ImageF drawn =
                with_set.draw(environment, from.view(1)).color->read<float>({0, 0, from.size, from.size}, 4);
            int before = 0;
            for (int y = 0; y < from.size; ++y) {
                for (int x = 0; x < from.size; ++x) {
                    const Vector3d ray = from.ray(x, y);
                    const Sphere& near = set.spheres[0];
                    const Vector3d eye = from.eye - Eigen::Vector3f(near.centre_m.data()).cast<double>();
                    // The other one is behind the wall.
                    if (!test::hit_sphere(from.eye, ray, 0.49) || !test::hit_sphere(eye, ray, 0.11)) continue;
                    ++before;
                    for (int c = 0; c < 3; ++c) {
                        const double sum = double(opacity) * light[c] + (1 - double(opacity)) * behind[c];
                        ASSERT_NEAR(drawn.at(x, y, c), sum, half_step) << int(method) << ", " << opacity;
                    }
                }
            }
            EXPECT_GT(before, 30);
        }
    }
}

TEST_F(TwoSetsTest, a_weighted_sum_is_that_of_double_precision) {
    add(0.12F);
    int over = 0, under = 0;
    const auto expected = [&](const std::vector<TransparentLayer>& layers) -> Eigen::Vector4d {
        const Eigen::Vector4d sum =
            light_and_cover([&](const Vector3d& behind) { return weighted_sum(layers, behind); });
        ++(sum[3] > 1 ? over : under);
        return sum / std::max(sum[3], 1.0);
    };
    EXPECT_LE(compared(draw(TransparencyMethod::weighted_sum), half_step, expected).first, most_grazing);
    EXPECT_GT(over, 100);
    EXPECT_GT(under, 100);
}

TEST_F(TwoSetsTest, weighted_blending_is_that_of_double_precision) {
    add(0.2F);
    double farthest_m = 0;
    for (const SphereSet& set : sets) farthest_m = std::max(farthest_m, set.bounds_m.max().y() - from.eye.y());
    const auto weight = [&](const TransparentLayer& layer) {
        return blended_weight(500 * layer.depth_m / farthest_m, layer.opacity);
    };
    const auto expected = [&](const std::vector<TransparentLayer>& layers) {
        return light_and_cover([&](const Vector3d& behind) { return weighted_blended(layers, behind, weight); });
    };
    EXPECT_LE(compared(draw(TransparencyMethod::weighted_blended), half_step, expected).first, most_grazing);
}

TEST_F(TwoSetsTest, moments_are_nearer_to_the_exact_composite_than_what_knows_less_of_the_order) {
    add(0.2F);
    const double by_moments = compared(draw(TransparencyMethod::moments), half_step, exact).second;
    const double by_weights = compared(draw(TransparencyMethod::weighted_blended), half_step, exact).second;
    const double by_sum = compared(draw(TransparencyMethod::weighted_sum), half_step, exact).second;
    EXPECT_LT(by_moments, by_weights);
    EXPECT_LT(by_weights, by_sum);
    // A fiftieth of the brightest light.
    EXPECT_LT(by_moments, 0.02);
    EXPECT_LT(compared(draw(TransparencyMethod::lists), half_step, exact).second, half_step);
}

TEST_F(TwoSetsTest, what_is_covered_is_exact_by_weights_and_moments) {
    add(0.2F);
    for (const TransparencyMethod method : {TransparencyMethod::weighted_blended, TransparencyMethod::moments}) {
        const ImageF drawn = draw(method);
        int off = 0;
        for (int y = 0; y < from.size; ++y) {
            for (int x = 0; x < from.size; ++x) {
                if (std::abs(drawn.at(x, y, 3) - exact(layers(x, y))[3]) > half_step) ++off;
            }
        }
        EXPECT_LE(off, most_grazing);
    }
}

TEST_F(SphereBlendingTest, those_at_one_place_and_opaque_ones_keep_their_light) {
    const Sphere one{{0.1F, 0, 0.3F}, 0.3F}, opaque{{-0.6F, 0, 0.3F}, 0.25F};
    SphereSet set = set_of({one, one, one, opaque});
    set.opacities = {0.5F, 0.5F, 0.5F, 1};
    surfaces.add_spheres({.material = glowing({0.9, 0.9, 0.9})}, set);
    for (const TransparencyMethod method : without_order) {
        const ImageF drawn = draw(method);
        // The sum of three halves is above one, and becomes one.
        const double covered = method == TransparencyMethod::weighted_sum ? 1 : 0.875;
        EXPECT_NEAR(drawn.at(32, 32, 3), covered, half_step) << int(method);
        EXPECT_NEAR(drawn.at(32, 32, 0), 0.9 * covered, half_step) << int(method);
        EXPECT_NEAR(drawn.at(6, 32, 3), 1, half_step) << int(method);
        EXPECT_NEAR(drawn.at(6, 32, 0), 0.9, half_step) << int(method);
        EXPECT_TRUE(std::ranges::all_of(drawn.samples(), [](float value) { return std::isfinite(value); }));
    }
}

TEST_F(SphereBlendingTest, where_no_sphere_lets_light_through_the_method_changes_no_bit) {
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2})}, random_set(300, 0.03F, 0.1F));
    const ImageF by_lists = draw(TransparencyMethod::lists);
    for (const TransparencyMethod method : without_order)
        EXPECT_TRUE(std::ranges::equal(by_lists.samples(), draw(method).samples())) << int(method);
}

TEST_F(SphereBlendingTest, what_is_passed_over_changes_no_pixel) {
    const Model wall = test::make_sphere(0.4);
    surfaces.add_object({.model = &wall, .material = glowing({0.2, 0.8, 0.5}), .id = 1});
    SphereSet set = random_set(120'000, 0.004F, 0.012F);
    set.opacity = 0.1F;
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2}), .id = 2}, set);
    surfaces.spheres()->visibility = {.frustum = false, .occlusion = false};
    const ImageF all = draw(TransparencyMethod::weighted_blended);
    const std::size_t all_cells = surfaces.spheres()->culling().cells_drawn();
    surfaces.spheres()->visibility = {.frustum = true, .occlusion = true};
    const ImageF tested = draw(TransparencyMethod::weighted_blended);
    EXPECT_LT(surfaces.spheres()->culling().cells_drawn(), all_cells);
    EXPECT_TRUE(std::ranges::equal(all.samples(), tested.samples()));
}

}  // namespace
}  // namespace matchlight
