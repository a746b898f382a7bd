// Few larger spheres in place of many small ones: as much is covered, in the same light.
#include <algorithm>
#include <cstddef>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/surface.h"
#include "render_scene.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

using test::random_set;

struct SphereDetailTest : GlTest {
    ShaderLibrary shaders;
    Environment environment{shaders,
                            test::make_probe(32, [](const Eigen::Vector3d& d) { return test::octant_color(d); })};
    SurfaceRenderer surfaces{shaders};
    test::TestCamera from{{0.1, -2, 0.3}, {0, 1, 0}, {1, 0, 0}, 129, 150};
    std::size_t spheres = 0;  // that the last draw drew

    ImageF draw(double detail_px) {
        SurfaceView view = from.view(1);
        view.sphere_detail_px = detail_px;
        const ImageF picture = surfaces.draw(environment, view).color->read<float>({0, 0, from.size, from.size}, 4);
        spheres = surfaces.spheres()->culling().spheres_drawn();
        return picture;
    }
    Eigen::Vector4d mean_of(const ImageF& picture) const {
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (int y = 0; y < from.size; ++y) {
            for (int x = 0; x < from.size; ++x) {
                for (int c = 0; c < 4; ++c) sum[c] += picture.at(x, y, c);
            }
        }
        return sum / (from.size * from.size);
    }
};

TEST_F(SphereDetailTest, fewer_cover_as_much_in_the_same_light) {
    // A pixel is 0.013 wide at their distance: radii of a twelfth of it.
    surfaces.add_spheres({}, random_set(150'000, 0.0009F, 0.0011F));
    surfaces.spheres()->visibility = {.frustum = false, .occlusion = false};
    const Eigen::Vector4d all = mean_of(draw(0));
    ASSERT_GT(all[3], 0.1);
    EXPECT_EQ(spheres, 150'000U);
    const Eigen::Vector4d few = mean_of(draw(0.5));
    EXPECT_LT(spheres, 150'000U / 6);
    // Chance: of 2,000 pixels that are covered, twice, one in 30 or so.
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(few[c], all[c], 0.1 * all[c]) << c;
}

TEST_F(SphereDetailTest, larger_spheres_are_drawn_as_they_are) {
    surfaces.add_spheres({}, random_set(3000, 0.01F, 0.03F));
    const ImageF all = draw(0);
    EXPECT_TRUE(std::ranges::equal(all.samples(), draw(0.5).samples()));
    EXPECT_EQ(spheres, 3000U);
}

TEST_F(SphereDetailTest, what_is_passed_over_changes_no_pixel) {
    from.size = 65;
    from.focal_px = 75;
    surfaces.add_spheres({}, random_set(150'000, 0.004F, 0.006F));
    surfaces.spheres()->visibility = {.frustum = false, .occlusion = false};
    const ImageF all = draw(0.5);
    const std::size_t before = spheres;
    EXPECT_LT(before, 150'000U);
    surfaces.spheres()->visibility = {.frustum = true, .occlusion = true};
    EXPECT_TRUE(std::ranges::equal(all.samples(), draw(0.5).samples()));
    EXPECT_LT(spheres, before);
}

}  // namespace
}  // namespace matchlight
