// What a material has beyond the plain ones: drawn as its numbers say, and at no cost for those that have less.
#include "render/surface_material.h"

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render_scene.h"

namespace matchlight {
namespace {

using test::make_sphere;
using test::make_square;
using test::TestCamera;
using test::uniform_probe;

const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
const TestCamera above{.eye = 4 * up, .forward = -up, .right = right};

class SurfaceMaterials : public GlTest {
protected:
    ImageF drawn(const Model& model, const TestCamera& camera = above) {
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &model});
        const SurfacePicture picture = renderer.draw(environment_, camera.view());
        return picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
    }
    /// A square that only shows its texture, as light: two texels wide, black and white.
    static Model shown_texture(const TextureSampling& sampling) {
        Model square = make_square(2);
        ModelTexture texture{"halves", Image8(2, 1, 4, 255), sampling};
        for (int c = 0; c < 3; ++c) texture.rgba.at(0, 0, c) = 0;
        square.textures.push_back(texture);
        square.materials[0].unlit = true;
        square.materials[0].texture(MaterialSlot::base_color) = 0;
        return square;
    }
    static void scale_uv(Model& model, float factor) {
        for (ModelVertex& vertex : model.meshes[0].vertices) vertex.uv[0] *= factor;
    }
    bool made(const char* define) const {
        for (const std::string& program : shaders_.made_programs()) {
            if (program.find(define) != std::string::npos) return true;
        }
        return false;
    }

    ShaderLibrary shaders_;
    Environment environment_{shaders_, uniform_probe(1)};
};

TEST_F(SurfaceMaterials, plain_ones_compile_nothing_of_the_others) {
    Model sphere = make_sphere(1, 24);
    drawn(sphere);
    EXPECT_FALSE(made("UV_MAPPINGS") || made("UNLIT"));
    sphere.materials[0].unlit = true;
    drawn(sphere);
    EXPECT_TRUE(made("UNLIT"));
}

TEST_F(SurfaceMaterials, of_neighbours_do_not_touch_the_plain) {
    Model plain = make_sphere(1, 24);
    const ImageF alone = drawn(plain);
    // A second mesh, far to the side, has another program.
    Model both = plain;
    ModelMesh aside = plain.meshes[0];
    for (ModelVertex& vertex : aside.vertices) vertex.position[0] += 100;
    aside.material = 1;
    both.materials.push_back(plain.materials[0]);
    both.materials[1].unlit = true;
    for (const bool first : {false, true}) {
        Model ordered = both;
        ordered.meshes.insert(first ? ordered.meshes.begin() : ordered.meshes.end(), aside);
        const ImageF image = drawn(ordered);
        EXPECT_TRUE(std::ranges::equal(image.samples(), alone.samples()));
    }
}

TEST_F(SurfaceMaterials, unlit_shows_its_colour_in_any_light) {
    Model square = make_square(2);
    square.materials[0].unlit = true;
    square.materials[0].base_color = {0.25F, 0.5F, 2, 1};
    const ImageF image = drawn(square);
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(image.at(64, 64, c), square.materials[0].base_color[static_cast<std::size_t>(c)]);
    }
    EXPECT_EQ(image.at(64, 64, 3), 1);
}

TEST_F(SurfaceMaterials, textures_repeat_mirror_and_end_as_they_should) {
    // Four pictures along the square: dark and bright halves.
    const auto seen = [&](TextureWrap wrap) {
        Model square = shown_texture(
            {.wrap_u = wrap, .mipmaps = TextureMipmaps::none, .is_smooth_near = false, .is_smooth_far = false});
        scale_uv(square, 4);
        const ImageF image = drawn(square);
        std::string text;
        // 80 pixels wide, 24 to 104: the middle of each eighth.
        for (int eighth = 0; eighth < 8; ++eighth) text += image.at(29 + 10 * eighth, 64, 0) > 0.5F ? '#' : '.';
        return text;
    };
    EXPECT_EQ(seen(TextureWrap::repeat), ".#.#.#.#");
    EXPECT_EQ(seen(TextureWrap::mirror), ".##..##.");
    EXPECT_EQ(seen(TextureWrap::clamp), ".#######");
}

TEST_F(SurfaceMaterials, texels_are_blocks_where_the_sampler_says_nearest) {
    const auto at_edge = [&](bool smooth) {
        return drawn(shown_texture({.wrap_u = TextureWrap::clamp, .is_smooth_near = smooth})).at(54, 64, 0);
    };
    // An eighth of the square's width left of the middle: a quarter of the way between the texels' middles.
    EXPECT_EQ(at_edge(false), 0);
    EXPECT_NEAR(at_edge(true), 0.25, 0.02);
}

TEST_F(SurfaceMaterials, small_textures_are_averaged_where_there_are_levels_of_them) {
    // 200 pictures along 80 pixels: without levels each pixel hits black or white.
    const auto spread = [&](TextureMipmaps mipmaps) {
        Model square = shown_texture({.mipmaps = mipmaps});
        scale_uv(square, 200.37F);
        const ImageF image = drawn(square);
        float least = 1, most = 0;
        for (int x = 34; x < 94; ++x) {
            least = std::min(least, image.at(x, 64, 0));
            most = std::max(most, image.at(x, 64, 0));
        }
        return most - least;
    };
    EXPECT_GT(spread(TextureMipmaps::none), 0.2);
    EXPECT_LT(spread(TextureMipmaps::linear), 1e-3);
}

TEST_F(SurfaceMaterials, each_texture_lies_in_its_own_place) {
    // Emission alone is seen, from its own half of the texture, by the second pair of coordinates.
    Model square = shown_texture({.mipmaps = TextureMipmaps::none, .is_smooth_near = false, .is_smooth_far = false});
    ModelMaterial& material = square.materials[0];
    material.unlit = false;
    material.base_color = {0, 0, 0, 1};
    material.metallic = 1;
    material.emissive = {1, 1, 1};
    material.use(MaterialSlot::emissive) = {0, {.rows = {1, 0, 0.5F, 0, 1, 0}}};
    ImageF image = drawn(square);
    EXPECT_NEAR(image.at(44, 64, 0), 1, 1e-3);
    EXPECT_NEAR(image.at(84, 64, 0), 0, 1e-3);
    material.use(MaterialSlot::emissive).mapping.of_second = true;
    for (ModelVertex& vertex : square.meshes[0].vertices) vertex.uv_second = {vertex.uv[1], 0.5F};
    image = drawn(square);
    EXPECT_NEAR(image.at(64, 44, 0), 1, 1e-3);
    EXPECT_NEAR(image.at(64, 84, 0), 0, 1e-3);
}

TEST_F(SurfaceMaterials, textures_of_one_texel_and_of_the_longest_row_are_stable) {
    for (const int width : {1, 16384}) {
        Model square = make_square(2);
        square.textures.push_back({"row", Image8(width, 1, 4, 255), {}});
        square.materials[0].unlit = true;
        square.materials[0].texture(MaterialSlot::base_color) = 0;
        const ImageF image = drawn(square);
        for (int x = 30; x < 100; x += 5) EXPECT_EQ(image.at(x, 64, 1), 1) << width;
    }
}

TEST_F(SurfaceMaterials, a_mirrored_half_of_a_texture_tilts_the_other_way) {
    // A normal map tilted along u, on a square whose u runs backwards: the light from the other side.
    Model square = make_square(2);
    square.materials[0] = test::metal(0.0);
    ModelTexture tilted{"tilted", Image8(1, 1, 4, 255), {}};
    tilted.rgba.at(0, 0, 0) = 191;  // sine of 30 degrees
    tilted.rgba.at(0, 0, 1) = 128;
    tilted.rgba.at(0, 0, 2) = 238;
    square.textures.push_back(tilted);
    square.materials[0].texture(MaterialSlot::normal) = 0;
    const Probe sides = test::make_probe(
        256, [](const Eigen::Vector3d& d) { return Eigen::Vector3d(d.x() > 0 ? 1 : 0, d.x() > 0 ? 0 : 1, 0); });
    const Environment environment(shaders_, sides);
    for (const bool mirrored : {false, true}) {
        Model shown = square;
        if (mirrored) {
            for (ModelVertex& vertex : shown.meshes[0].vertices) vertex.tangent = {-1, 0, 0, -1};
        }
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &shown});
        const SurfacePicture picture = renderer.draw(environment, above.view());
        const ImageF image = picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
        EXPECT_NEAR(image.at(64, 64, 0), mirrored ? 0 : 1, 0.02);
        EXPECT_NEAR(image.at(64, 64, 1), mirrored ? 1 : 0, 0.02);
    }
}

}  // namespace
}  // namespace matchlight
