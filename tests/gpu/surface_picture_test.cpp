// The gathered picture of the real surface on the GPU: looked up where it is, weighed by knowledge, gone at its border.
#include <cmath>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "gl_fixture.h"
#include "render/surface_picture_map.h"

namespace matchlight {
namespace {

class SurfacePictureLookup : public GlTest {
protected:
    /// A metre of 64 texels a side from (−0.25, 2): red grows with x, green with y, blue is 2; known where y < 2.5.
    static std::shared_ptr<GatheredSurface> slopes() {
        auto gathered = std::make_shared<GatheredSurface>();
        gathered->radiance = ImageF(64, 64, 4);
        gathered->clipped = ImageF(64, 64, 1);
        gathered->rectangle_m = {Eigen::Vector2d(-0.25, 2), Eigen::Vector2d(0.75, 3)};
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const float light[] = {(static_cast<float>(x) + 0.5f) / 64, (static_cast<float>(y) + 0.5f) / 64, 2.0f};
                std::copy_n(light, 3, gathered->radiance.pixel(x, y));
                gathered->radiance.at(x, y, 3) = y < 32 ? 1.0f : 0.0f;
            }
        }
        return gathered;
    }

    /// surface_picture() at a place.
    static Eigen::Vector4f at(const SurfacePictureMap& map, const Eigen::Vector2f& xy_m, double footprint_m) {
        ShaderLibrary shaders;
        Program& program = shaders.full_screen("../tests/gpu/shaders/surface_picture.frag");
        Texture2D target({.format = GL_RGBA32F});
        const Framebuffer framebuffer({target});
        framebuffer.bind();
        program.use();
        map.bind(program, 3);
        program.set("xy_m", xy_m);
        program.set("footprint_m", footprint_m);
        FullScreenTriangle().draw();
        Eigen::Vector4f value;
        target.read(target.bounds(), std::span<float>(value.data(), 4));
        return value;
    }
};

// Half floats hold 11 bits.
constexpr float half_step = 1e-3f;

TEST_F(SurfacePictureLookup, light_lies_where_it_was_gathered) {
    const SurfacePictureMap map(slopes());
    const Eigen::Vector4f seen = at(map, {0.25f, 2.25f}, 0);
    EXPECT_NEAR(seen[0], 0.5f, half_step);
    EXPECT_NEAR(seen[1], 0.25f, half_step);
    EXPECT_NEAR(seen[2], 2.0f, 2 * half_step);
    EXPECT_EQ(seen[3], 1.0f);
}

TEST_F(SurfacePictureLookup, wide_footprints_average_what_is_known) {
    // An eighth of a metre about the line where knowledge ends: half of it is known, and its light is that of the
    // known half.
    const Eigen::Vector4f seen = at(SurfacePictureMap(slopes()), {0.25f, 2.5f}, 0.125);
    EXPECT_NEAR(seen[3], 0.5f, half_step);
    EXPECT_NEAR(seen[2] / seen[3], 2.0f, 4 * half_step);
    EXPECT_NEAR(seen[1] / seen[3], 0.4375f, 4 * half_step);
}

TEST_F(SurfacePictureLookup, knowledge_falls_to_nothing_at_the_border) {
    const SurfacePictureMap map(slopes());
    EXPECT_EQ(at(map, {-0.3f, 2.2f}, 0.01), Eigen::Vector4f::Zero());
    EXPECT_EQ(at(map, {0.75f, 2.2f}, 0.1), Eigen::Vector4f::Zero());
    EXPECT_NEAR(at(map, {0.725f, 2.2f}, 0.1)[3], 0.25f, 0.01f);  // a quarter of the footprint from it
    EXPECT_EQ(at(map, {0.6f, 2.2f}, 0.1)[3], 1.0f);
    EXPECT_EQ(at(map, {std::nanf(""), 2.2f}, 0.1), Eigen::Vector4f::Zero());
}

TEST_F(SurfacePictureLookup, without_a_picture_nothing_is_known) {
    const SurfacePictureMap map(nullptr);
    EXPECT_FALSE(map.present());
    EXPECT_EQ(at(map, {0.25f, 2.25f}, 0.1), Eigen::Vector4f::Zero());
}

}  // namespace
}  // namespace matchlight
