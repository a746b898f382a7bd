// At the edges of spheres a pixel takes the share that each covers of it.
#include "render/sphere_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render/virtual_layer.h"
#include "render_scene.h"
#include "scene/sphere_caster.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

using test::glowing;
using test::random_set;
using test::set_of;
using test::TestCamera;

constexpr double sixteenth = 1.0 / 16;

struct SphereEdgesTest : GlTest {
    ShaderLibrary shaders;
    Environment environment{shaders, test::uniform_probe(1)};
    SurfaceRenderer surfaces{shaders};
    std::deque<SphereSet> sets;  // the caster looks at them
    SphereCaster caster;
    TestCamera from{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 97, 90};

    /// Each set sends its own channel's light.
    void add(const SphereSet& set) {
        const int channel = static_cast<int>(sets.size());
        std::array<double, 3> light{};
        light.at(sets.size()) = 1;
        surfaces.add_spheres({.material = glowing(light), .id = channel + 1}, sets.emplace_back(set));
        caster.add_set(sets.back());
    }
    ImageF draw(int places, int samples = 1) {
        SurfaceView view = from.view(samples);
        view.sphere_edge_places = places;
        return surfaces.draw(environment, view).color->read<float>({0, 0, from.size, from.size}, 4);
    }
    /// What each set covers of a pixel, and all together.
    Eigen::Vector4d shares(int x, int y, int places = 16) const {
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (int row = 0; row < places; ++row) {
            for (int column = 0; column < places; ++column) {
                const double u = x + (column + 0.5) / places - 0.5, v = y + (row + 0.5) / places - 0.5;
                const auto hit = caster.nearest({.origin_m = from.eye, .direction = from.ray(u, v), .least = 1e-3});
                if (!hit) continue;
                sum[static_cast<Eigen::Index>(hit->set)] += 1;
                sum[3] += 1;
            }
        }
        return sum / (places * places);
    }
    struct Errors {
        double largest = 0, mean = 0;
        int pixels = 0, large = 0;
    };
    /// Of the pixels that are no one set's alone.
    Errors errors_of(const ImageF& drawn) const {
        Errors errors;
        for (int y = 0; y < from.size; ++y) {
            for (int x = 0; x < from.size; ++x) {
                const Eigen::Vector4d expected = shares(x, y);
                if (expected.maxCoeff() == 0 || expected.head<3>().maxCoeff() == 1) continue;
                double off = 0;
                for (int c = 0; c < 4; ++c)
                    off = std::max(off, std::abs(static_cast<double>(drawn.at(x, y, c)) - expected[c]));
                errors.largest = std::max(errors.largest, off);
                errors.mean += off;
                errors.large += off > sixteenth ? 1 : 0;
                ++errors.pixels;
            }
        }
        errors.mean /= std::max(errors.pixels, 1);
        return errors;
    }
};

TEST_F(SphereEdgesTest, a_silhouette_covers_its_share_to_a_sixteenth) {
    add(set_of({{{0.2F, 0, 0.4F}, 0.5F}, {{-0.6F, -0.5F, -0.2F}, 0.05F}, {{-0.5F, 0, 0.6F}, 0.2F}}));
    const Errors middles = errors_of(draw(0)), shared = errors_of(draw(8));
    EXPECT_GT(middles.largest, 0.4);
    EXPECT_GT(shared.pixels, 150);
    EXPECT_LE(shared.largest, sixteenth);
    EXPECT_LT(shared.mean, 0.012);
}

TEST_F(SphereEdgesTest, where_spheres_hide_or_cut_each_other_each_has_its_share) {
    add(set_of({{{0, 0, 0.3F}, 0.5F}, {{-0.7F, 0.3F, 0}, 0.3F}}));
    add(set_of({{{0.3F, -0.25F, 0.5F}, 0.4F}, {{-0.6F, 0.2F, 0.1F}, 0.3F}}));
    add(set_of({{{0.1F, -0.9F, 0}, 0.1F}, {{-0.3F, 0.9F, 0.5F}, 0.4F}}));
    const Errors shared = errors_of(draw(8));
    EXPECT_GT(shared.pixels, 250);
    EXPECT_LE(shared.largest, sixteenth);
}

TEST_F(SphereEdgesTest, a_horizon_of_a_million_radii_is_one) {
    // From a metre above the ground of a planet.
    add(set_of({{{0, 0, -1e6F}, 1e6F}}));
    from.eye = {0, 0, 1};
    const Errors middles = errors_of(draw(0)), shared = errors_of(draw(8));
    EXPECT_GE(shared.pixels, from.size);
    EXPECT_GT(middles.largest, 0.3);
    EXPECT_LE(shared.largest, sixteenth);
}

TEST_F(SphereEdgesTest, of_many_the_picture_is_nearer_to_the_truth) {
    // A pixel is 0.02 wide at their distance: many are hardly larger, and some are seen by no pixel's middle.
    add(random_set(700, 0.02F, 0.05F));
    SphereSet others = random_set(900, 0.02F, 0.05F);
    others.spheres.erase(others.spheres.begin(), others.spheres.begin() + 200);
    add(others);
    const Errors middles = errors_of(draw(0)), shared = errors_of(draw(8));
    EXPECT_LT(shared.mean, middles.mean / 4);
    EXPECT_LT(shared.large, middles.large / 4);
}

TEST_F(SphereEdgesTest, meshes_keep_their_place_before_and_behind) {
    add(set_of({{{0, 0, 0.3F}, 0.4F}}));
    Model square = test::make_square(4);
    // Facing the eye, once behind and once before.
    Eigen::Matrix4d facing = Eigen::Matrix4d::Identity();
    facing.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    for (const double y : {1.0, -1.0}) {
        facing(1, 3) = y;
        SurfaceRenderer both(shaders);
        both.add_spheres({.material = glowing({1, 0, 0}), .id = 1}, set_of({{{0, 0, 0.3F}, 0.4F}}));
        both.add_object({.model = &square, .world_from_model = facing, .material = glowing({0, 1, 0}), .id = 2});
        for (const int samples : {1, 4}) {
            SurfaceView view = from.view(samples);
            view.sphere_edge_places = 8;
            const ImageF drawn = both.draw(environment, view).color->read<float>({0, 0, from.size, from.size}, 4);
            for (int row = 0; row < from.size; ++row) {
                for (int x = 0; x < from.size; ++x) {
                    const double red = y > 0 ? shares(x, row, 16)[0] : 0;
                    ASSERT_NEAR(drawn.at(x, row, 0), red, sixteenth + 0.002) << x << ", " << row << ", " << samples;
                    ASSERT_NEAR(drawn.at(x, row, 1), 1 - red, sixteenth + 0.002) << x << ", " << row << ", " << samples;
                }
            }
        }
    }
}

TEST_F(SphereEdgesTest, pixels_away_from_edges_and_pictures_without_spheres_are_not_changed) {
    add(set_of({{{0.2F, 0, 0.4F}, 0.5F}}));
    const ImageF middles = draw(0), one = draw(1), shared = draw(8);
    EXPECT_TRUE(std::ranges::equal(middles.samples(), one.samples()));
    int inside = 0;
    for (int y = 1; y + 1 < from.size; ++y) {
        for (int x = 1; x + 1 < from.size; ++x) {
            bool is_edge = false;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx)
                    is_edge = is_edge || middles.at(x + dx, y + dy, 3) != middles.at(x, y, 3);
            }
            if (is_edge) continue;
            ++inside;
            for (int c = 0; c < 4; ++c) ASSERT_EQ(shared.at(x, y, c), middles.at(x, y, c));
        }
    }
    EXPECT_GT(inside, 1000);

    SurfaceRenderer meshes(shaders);
    Model mesh = test::make_sphere(0.5);
    meshes.add_object({.model = &mesh, .material = glowing({1, 1, 0})});
    SurfaceView view = from.view(4);
    const ImageF without = meshes.draw(environment, view).color->read<float>({0, 0, from.size, from.size}, 4);
    view.sphere_edge_places = 8;
    const ImageF with = meshes.draw(environment, view).color->read<float>({0, 0, from.size, from.size}, 4);
    EXPECT_TRUE(std::ranges::equal(without.samples(), with.samples()));
}

TEST_F(SphereEdgesTest, the_lens_blurs_a_mixed_pixel_as_the_sphere_that_it_shows) {
    add(set_of({{{0, 0, 0.3F}, 0.5F}}));
    SurfaceView view = from.view(1);
    view.sphere_edge_places = 8;
    view.lens = SurfaceLens{.focus = {.coc_scale_px_m = 10, .focus_distance_m = 1},
                            .range = {.nearest_px = 20, .farthest_px = 20},
                            .focuses_reflections = false};
    const SurfacePicture picture = surfaces.draw(environment, view);
    const ImageF light = picture.color->read<float>({0, 0, from.size, from.size}, 4);
    const ImageF focus = picture.focus_share->read<float>({0, 0, from.size, from.size}, 1);

    int mixed = 0;
    for (int y = 0; y < from.size; ++y) {
        for (int x = 0; x < from.size; ++x) {
            const float alpha = light.at(x, y, 3);
            if (alpha <= 0) continue;
            mixed += alpha < 1 ? 1 : 0;
            const double z_m = near_plane_m * alpha / focus.at(x, y, 0);
            ASSERT_GT(z_m, 1.4);
            ASSERT_LT(z_m, 2.0);
        }
    }
    EXPECT_GT(mixed, 50);
}

TEST(CameraFromNdc, is_the_rays_of_a_view) {
    const TestCamera from{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 97, 90};
    const Eigen::Matrix4d clip = from.view(1).clip_from_world;
    Eigen::Matrix3d axes;
    axes << clip.row(0).head<3>(), clip.row(1).head<3>(), clip.row(3).head<3>();
    const Eigen::Matrix3d rays = camera_from_ndc(axes);
    // The right edge of the picture is half of it away from the middle.
    const Eigen::Vector3d right = rays * Eigen::Vector3d(1, 0, 1);
    EXPECT_NEAR(right.x(), from.size / 2.0 / from.focal_px, 1e-12);
    EXPECT_NEAR(right.y(), 0, 1e-12);
    EXPECT_NEAR(right.z(), 1, 1e-12);
    // Camera axes are square to each other and of unit length.
    EXPECT_TRUE((rays * axes * (rays * axes).transpose()).isIdentity(1e-12));
}

}  // namespace
}  // namespace matchlight
