// Halos of spheres against every pixel around each in double precision; without any no bit changes.
#include <algorithm>
#include <cmath>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render_scene.h"
#include "report/sphere_reference.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

using test::glowing;
using test::random_set;
using test::TestCamera;

struct SphereHaloTest : GlTest {
    static ShaderLibrary& shaders() {
        static ShaderLibrary library;
        return library;
    }
    Environment environment{shaders(), test::uniform_probe(1)};
    SurfaceRenderer surfaces{shaders()};
    const SphereSet set = random_set(150, 0.03F, 0.12F);

    ImageF draw(const ReferenceView& seen, int step_px) {
        SurfaceView view;
        view.clip_from_world = clip_from_camera(seen.pinhole) * seen.camera_from_world.matrix();
        view.eye_world_m = seen.camera_from_world.inverse().translation();
        view.width = seen.width();
        view.height = seen.height();
        view.samples = 1;
        view.halo_step_px = step_px;
        return surfaces.draw(environment, view).color->read<float>({0, 0, view.width, view.height}, 4);
    }
    static ReferenceView view_of(int side_px) {
        ReferenceView view;
        view.camera_from_world =
            camera_looking_along(Eigen::Vector3d(0.1, -2, 0.3), Eigen::Vector3d(0, 1, -0.1).normalized());
        view.pinhole = {.fx = 1.2 * side_px,
                        .fy = 1.2 * side_px,
                        .cx = (side_px - 1) / 2.0,
                        .cy = (side_px - 1) / 2.0,
                        .width = double(side_px),
                        .height = double(side_px),
                        .near_m = 0.01};
        return view;
    }
};

TEST_F(SphereHaloTest, are_those_of_every_pixel_around) {
    const SphereHalo halo{.strength = 0.7, .width_deg = 2, .depth_m = 0.2};
    surfaces.add_spheres({.material = glowing({1, 1, 1}), .halo = halo}, set);
    SphereCaster rays;
    rays.add_set(set);
    const ReferenceView view = view_of(129);
    const ImageF drawn = draw(view, 1), coarse = draw(view, 3);
    const Image<double> expected = reference_halos(rays, view, halo);
    int dark = 0, off = 0;
    double mean = 0, coarse_mean = 0;
    for (int y = 0; y < 129; ++y) {
        for (int x = 0; x < 129; ++x) {
            if (drawn.at(x, y, 3) <= 0) continue;
            const double error = std::abs(drawn.at(x, y, 0) - expected.at(x, y));
            dark += expected.at(x, y) < 0.6 ? 1 : 0;
            off += error > 2e-3 ? 1 : 0;  // half floats
            mean += error;
            coarse_mean += std::abs(coarse.at(x, y, 0) - expected.at(x, y));
        }
    }
    EXPECT_GT(dark, 500);
    // A ray that grazes a sphere may meet or miss it by rounding, and its halo with it.
    EXPECT_LT(off, 40);
    EXPECT_LT(mean, 0.2 * coarse_mean);
}

TEST_F(SphereHaloTest, none_and_those_of_no_strength_change_no_bit) {
    surfaces.add_spheres({.material = glowing({1, 0.5, 0.2})}, set);
    const ReferenceView view = view_of(65);
    const ImageF without = draw(view, 1);
    surfaces.set_halo(0, {.strength = 0, .width_deg = 2});
    EXPECT_TRUE(std::ranges::equal(without.samples(), draw(view, 1).samples()));
    // Nothing lies behind anything within a millionth of a degree: the program that looks finds none.
    surfaces.set_halo(0, {.strength = 1, .width_deg = 1e-6});
    EXPECT_TRUE(std::ranges::equal(without.samples(), draw(view, 1).samples()));
    surfaces.set_halo(0, {.strength = 1, .width_deg = 2});
    EXPECT_FALSE(std::ranges::equal(without.samples(), draw(view, 1).samples()));
}

}  // namespace
}  // namespace matchlight
