// Textures as pictures: where texels stand, and what is white.
#include "preview/texture_picture.h"

#include <limits>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

WatchedTexture part_of_a_frame() {
    // Two by one texels of four pixels a side, from the second column and row on.
    WatchedTexture texture{"bloom/down 2", {.format = GL_RGBA16F, .region = {1, 1, 2, 1}, .scale = 4}, ImageF(2, 1, 4)};
    texture.texels.at(0, 0, 0) = 12;
    texture.texels.at(1, 0, 1) = std::numeric_limits<float>::quiet_NaN();
    return texture;
}

TEST(TexturePicture, LiesWhereTheFrameHasIt) {
    const Image8 picture = picture_of_texture(part_of_a_frame(), 16, 12);
    ASSERT_EQ(picture.width(), 16);
    ASSERT_EQ(picture.height(), 12);
    EXPECT_EQ(picture.at(4, 4, 0), 255) << "the largest value is white";
    EXPECT_EQ(picture.at(7, 7, 0), 255);
    EXPECT_EQ(picture.at(3, 4, 0), 0);
    EXPECT_EQ(picture.at(7, 8, 0), 0);
    // What is no number is seen.
    EXPECT_EQ(picture.at(8, 4, 0), 255);
    EXPECT_EQ(picture.at(8, 4, 1), 0);
    EXPECT_EQ(picture.at(8, 4, 2), 255);
    EXPECT_EQ(words_of_texture(part_of_a_frame()), "bloom/down 2: 2×1 texels of 4 pixels, 0 to 12");
}

TEST(TexturePicture, DepthsGoFromTheNearestToTheFarthest) {
    WatchedTexture texture{"depth", {.format = GL_DEPTH_COMPONENT32F, .region = {0, 0, 3, 1}}, ImageF(3, 1, 1)};
    texture.texels.at(1, 0) = 0.2f;  // the first is empty: reversed z
    texture.texels.at(2, 0) = 0.4f;
    const Image8 picture = picture_of_texture(texture, 3, 1);
    EXPECT_EQ(picture.at(0, 0, 0), 0);
    EXPECT_EQ(picture.at(1, 0, 0), 0);
    EXPECT_EQ(picture.at(2, 0, 2), 255);
}

TEST(TexturePicture, MapsOfTheLightAreFittedIn) {
    WatchedTexture texture{"shadow", {.format = GL_R32F, .region = {0, 0, 400, 400}}, ImageF(400, 400, 4)};
    for (int i = 0; i < 400; ++i) texture.texels.at(i, 20, 0) = 1;
    const Image8 picture = picture_of_texture(texture, 20, 10);
    // Forty texels a pixel: ten by ten pixels in the middle.
    EXPECT_EQ(picture.at(5, 0, 0), 255);
    EXPECT_EQ(picture.at(14, 0, 0), 255);
    EXPECT_EQ(picture.at(5, 1, 0), 0);
    EXPECT_EQ(picture.at(4, 0, 0), 0);
    EXPECT_EQ(picture.at(15, 0, 0), 0);
}

TEST(TexturePicture, WithoutNumbersIsBlack) {
    WatchedTexture texture{"none", {.format = GL_RGBA16F, .region = {0, 0, 2, 2}}, ImageF(2, 2, 4)};
    const Image8 picture = picture_of_texture(texture, 2, 2);
    for (const std::uint8_t code : picture.samples()) EXPECT_EQ(code, 0);
}

}  // namespace
}  // namespace matchlight
