// Buffers, textures and framebuffers give back what was put in.
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Core>

#include "gl/framebuffer.h"
#include "gl_fixture.h"

namespace matchlight {
namespace {

class Objects : public GlTest {};

template <class Sample>
Image<Sample> counting_image(int width, int height, int channels) {
    Image<Sample> image(width, height, channels);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < channels; ++c) image.at(x, y, c) = static_cast<Sample>(c + channels * (x + width * y));
        }
    }
    return image;
}

TEST_F(Objects, buffers_round_trip) {
    std::vector<std::uint32_t> numbers(100);
    std::iota(numbers.begin(), numbers.end(), 7U);
    Buffer buffer{std::span<const std::uint32_t>(numbers)};
    const std::uint32_t changed[] = {1000};
    buffer.upload(std::span<const std::uint32_t>(changed), 5 * sizeof(std::uint32_t));
    std::vector<std::uint32_t> back(100);
    buffer.read(std::span<std::uint32_t>(back));
    numbers[5] = 1000;
    EXPECT_EQ(back, numbers);
}

TEST_F(Objects, moving_leaves_one_owner) {
    Texture2D first({.format = GL_R32F, .width = 2, .height = 2});
    const GLuint name = first.name();
    Texture2D second = std::move(first);
    EXPECT_EQ(second.name(), name);
    second = Texture2D({.format = GL_R32F, .width = 1, .height = 1});
    EXPECT_NE(second.name(), name);
}

TEST_F(Objects, textures_round_trip_in_every_client_type) {
    const ImageF floats = counting_image<float>(5, 3, 3);  // odd widths catch row padding
    Texture2D float_texture({.format = GL_RGBA32F, .width = 5, .height = 3});
    float_texture.upload(floats);
    const ImageF float_back = float_texture.read<float>(float_texture.bounds(), 3);
    EXPECT_TRUE(std::ranges::equal(float_back.samples(), floats.samples()));

    const Image8 bytes = counting_image<std::uint8_t>(5, 3, 4);
    Texture2D byte_texture({.format = GL_RGBA8, .width = 5, .height = 3});
    byte_texture.upload(bytes);
    EXPECT_TRUE(std::ranges::equal(byte_texture.read<std::uint8_t>(bytes.bounds(), 4).samples(), bytes.samples()));

    const Image16 shorts = counting_image<std::uint16_t>(5, 3, 1);
    Texture2D short_texture({.format = GL_R16, .width = 5, .height = 3});
    short_texture.upload(shorts);
    EXPECT_TRUE(std::ranges::equal(short_texture.read<std::uint16_t>(shorts.bounds(), 1).samples(), shorts.samples()));

    Image16 halves(5, 3, 4);
    for (std::size_t i = 0; i < halves.samples().size(); ++i) {
        halves.samples()[i] = Eigen::half(static_cast<float>(i) / 8).x;
    }
    Texture2D half_texture({.format = GL_RGBA16F, .width = 5, .height = 3});
    half_texture.upload(halves);
    EXPECT_TRUE(std::ranges::equal(half_texture.read<std::uint16_t>(halves.bounds(), 4).samples(), halves.samples()));

    const auto ids = counting_image<std::uint32_t>(5, 3, 1);
    Texture2D id_texture({.format = GL_R32UI, .width = 5, .height = 3});
    id_texture.upload(ids);
    EXPECT_TRUE(std::ranges::equal(id_texture.read<std::uint32_t>(ids.bounds(), 1).samples(), ids.samples()));
}

TEST_F(Objects, a_region_is_written_and_read_alone) {
    Texture2D texture({.format = GL_R32F, .width = 8, .height = 6});
    texture.clear(-1, 0, 0, 0);
    const Region region{2, 1, 3, 4};
    const ImageF part = counting_image<float>(3, 4, 1);
    texture.upload(region, part.samples());
    const ImageF all = texture.read<float>(texture.bounds(), 1);
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 8; ++x) {
            EXPECT_EQ(all.at(x, y), region.contains(x, y) ? part.at(x - 2, y - 1) : -1);
        }
    }
    const Framebuffer framebuffer({texture});
    EXPECT_TRUE(std::ranges::equal(framebuffer.read<float>(region, 1).samples(), part.samples()));
}

TEST_F(Objects, layers_and_faces_are_apart) {
    Texture2D array({.format = GL_R32F, .width = 2, .height = 2, .layers = 3});
    TextureCube cube(GL_RGBA32F, 2, 2);
    for (int i = 0; i < 3; ++i) {
        const std::vector<float> filled(4, static_cast<float>(i));
        array.upload<float>(array.bounds(), filled, 0, i);
    }
    for (int face = 0; face < 6; ++face) {
        const std::vector<float> filled(16, static_cast<float>(face));
        cube.upload<float>(0, face, filled);
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(array.read<float>({1, 1, 1, 1}, 1, 0, i).at(0, 0), static_cast<float>(i));
    for (int face = 0; face < 6; ++face) {
        std::vector<float> back(16);
        cube.read<float>(0, face, back);
        EXPECT_EQ(back[7], static_cast<float>(face));
    }
}

TEST_F(Objects, mipmaps_average) {
    Texture2D texture({.format = GL_R32F, .width = 4, .height = 4, .levels = 0});
    EXPECT_EQ(texture.shape().levels, 3);
    texture.upload(counting_image<float>(4, 4, 1));
    texture.make_mipmaps();
    EXPECT_FLOAT_EQ(texture.read<float>({0, 0, 1, 1}, 1, 2).at(0, 0), 7.5F);
}

TEST_F(Objects, multisampled_colour_resolves_to_its_mean) {
    const Texture2D many({.format = GL_RGBA32F, .width = 8, .height = 8, .samples = 4});
    const Texture2D one({.format = GL_RGBA32F, .width = 8, .height = 8});
    const Framebuffer from({many});
    const Framebuffer to({one});
    to.clear_color(0, 9, 9, 9, 9);
    from.clear_color(0, 1, 2, 3, 0.5F);
    from.resolve_color_to(to, {2, 3, 4, 2});
    const ImageF seen = to.read<float>(to.bounds(), 4);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            EXPECT_EQ(seen.at(x, y, 1), Region({2, 3, 4, 2}).contains(x, y) ? 2.0F : 9.0F) << x << ' ' << y;
        }
    }
}

TEST_F(Objects, integer_attachments_clear) {
    const Texture2D ids({.format = GL_R32UI, .width = 3, .height = 3});
    const Framebuffer framebuffer({ids});
    framebuffer.clear_color_integer(0, 4000000000U);
    EXPECT_EQ(framebuffer.read<std::uint32_t>({2, 2, 1, 1}, 1).at(0, 0), 4000000000U);
}

}  // namespace
}  // namespace matchlight
