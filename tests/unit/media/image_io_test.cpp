// Pictures and EXR files come back as they were written; names of sequences.
#include "media/image_io.h"

#include <cmath>

#include <gmock/gmock.h>

#include "file_size_limit.h"
#include "scratch_folder.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ImageIo : public ScratchFolder {};

template <class Sample>
Image<Sample> ramp(int width, int height, int channels, int step) {
    Image<Sample> image(width, height, channels);
    for (std::size_t i = 0; i < image.samples().size(); ++i)
        image.samples()[i] = static_cast<Sample>(i * static_cast<std::size_t>(step));
    return image;
}

TEST_F(ImageIo, EightBitPngComesBackExactly) {
    const Image8 image = ramp<std::uint8_t>(37, 21, 3, 7);
    write_png8(folder_ / "a b.png", image, {{"matchlight_scene", "line one\nline two"}});
    const Image8 read = read_rgb8(folder_ / "a b.png");
    EXPECT_TRUE(std::ranges::equal(image.samples(), read.samples()));
    EXPECT_EQ(picture_bit_depth(folder_ / "a b.png"), 8);
    EXPECT_THAT(bytes_of(folder_ / "a b.png"), HasSubstr("line one\nline two"));
}

TEST_F(ImageIo, SixteenBitPngComesBackExactlyAndIsRoundedToEight) {
    const Image16 image = ramp<std::uint16_t>(64, 40, 3, 257);
    write_png16(folder_ / "deep.png", image);
    EXPECT_EQ(picture_bit_depth(folder_ / "deep.png"), 16);
    EXPECT_TRUE(std::ranges::equal(image.samples(), read_rgb16(folder_ / "deep.png").samples()));
    const Image8 rounded = read_rgb8(folder_ / "deep.png");
    for (std::size_t i = 0; i < rounded.samples().size(); ++i)
        ASSERT_EQ(rounded.samples()[i], std::lround(image.samples()[i] / 257.0)) << i;
}

TEST_F(ImageIo, AlphaIsDroppedWithoutTouchingColour) {
    Image8 image(2, 1, 4);
    const std::uint8_t samples[] = {200, 100, 50, 10, 1, 2, 3, 0};
    std::ranges::copy(samples, image.samples().begin());
    write_png8(folder_ / "alpha.png", image);
    const Image8 read = read_rgb8(folder_ / "alpha.png");
    EXPECT_THAT(std::vector(read.samples().begin(), read.samples().end()), testing::ElementsAre(200, 100, 50, 1, 2, 3));
}

TEST_F(ImageIo, GreyIsSpreadAndMasksAreBinary) {
    const Image8 image = ramp<std::uint8_t>(5, 2, 1, 1);
    write_png8(folder_ / "grey.png", image);
    const Image8 read = read_rgb8(folder_ / "grey.png");
    ASSERT_EQ(read.channels(), 3);
    for (int x = 0; x < 5; ++x) EXPECT_EQ(read.at(x, 1, 2), image.at(x, 1));
    const Image8 mask = read_mask(folder_ / "grey.png");
    EXPECT_EQ(mask.at(0, 0), 0);
    EXPECT_EQ(mask.at(1, 0), 255);
}

TEST_F(ImageIo, MultiPartExrKeepsEveryLayer) {
    ImageF beauty(8, 6, 4), depth(3, 2, 1);
    for (std::size_t i = 0; i < beauty.samples().size(); ++i)
        beauty.samples()[i] = static_cast<float>(i) / 8;  // exact in half
    for (std::size_t i = 0; i < depth.samples().size(); ++i) depth.samples()[i] = 1.0f / 3 + static_cast<float>(i);
    write_exr(folder_ / "layers.exr", 8, 6,
              {{"beauty", {"R", "G", "B", "A"}, &beauty, true, {}}, {"depth", {"Z"}, &depth, false, {4, 3, 3, 2}}},
              {{"matchlight_seed", "7"}});
    const ImageF read = read_exr_part(folder_ / "layers.exr", "beauty", {"R", "G", "B", "A"});
    EXPECT_TRUE(std::ranges::equal(beauty.samples(), read.samples()));
    const ImageF z = read_exr_part(folder_ / "layers.exr", "depth", {"Z"});
    ASSERT_EQ(z.width(), 8);
    EXPECT_EQ(z.at(4, 3), depth.at(0, 0));
    EXPECT_EQ(z.at(6, 4), depth.at(2, 1));
    EXPECT_EQ(z.at(3, 3), 0);
    const ImageF rgb = read_linear_rgb(folder_ / "layers.exr", warnings_);
    EXPECT_EQ(rgb.at(2, 1, 1), beauty.at(2, 1, 1));
    EXPECT_THAT(bytes_of(folder_ / "layers.exr"), HasSubstr("matchlight_seed"));
    EXPECT_TRUE(warnings_.empty());
    EXPECT_THAT(error_of([&] { read_exr_part(folder_ / "layers.exr", "shadow", {"A"}); }), HasSubstr("shadow"));
}

TEST_F(ImageIo, LuminanceOnlyExrIsSpread) {
    ImageF gray(4, 2, 1, 0.25f);
    write_exr(folder_ / "y.exr", 4, 2, {{"", {"Y"}, &gray, false, {}}}, {});
    const ImageF rgb = read_linear_rgb(folder_ / "y.exr", warnings_);
    ASSERT_EQ(rgb.channels(), 3);
    EXPECT_EQ(rgb.at(3, 1, 2), 0.25f);
}

TEST_F(ImageIo, NamesOfSequences) {
    EXPECT_EQ(numbered("out/a_%04d.png", 7), "out/a_0007.png");
    EXPECT_EQ(numbered("a_%d.png", 12345), "a_12345.png");
    EXPECT_EQ(numbered("100%.png", 3), "100%.png");
    EXPECT_EQ(numbered("fixed.png", 3), "fixed.png");
    EXPECT_TRUE(is_pattern("f%03d.jpg"));
    EXPECT_FALSE(is_pattern("folder%03d/f.jpg"));
    for (const char* bad : {"a%4d.png", "a%s.png", "a%04d_%04d.png", "a%099d.png", "a%0d.png"})
        EXPECT_THROW(numbered(bad, 0), InputError) << bad;
}

TEST_F(ImageIo, AFileTheDiskRefusesIsAnErrorAndLeavesNothing) {
    Image8 noise(200, 200, 3);
    unsigned state = 1;
    for (std::uint8_t& sample : noise.samples())
        sample = static_cast<std::uint8_t>((state = state * 1664525 + 1) >> 24);
    ImageF linear(200, 200, 3);
    for (std::size_t i = 0; i < linear.samples().size(); ++i) linear.samples()[i] = noise.samples()[i];
    {
        const FileSizeLimit limit(20000);
        EXPECT_THAT(error_of([&] { write_png8(folder_ / "full.png", noise); }), HasSubstr("full.png"));
        EXPECT_THAT(error_of([&] {
                        write_exr(folder_ / "full.exr", 200, 200, {{"beauty", {"R", "G", "B"}, &linear, true, {}}}, {});
                    }),
                    HasSubstr("full.exr"));
    }
    EXPECT_TRUE(fs::is_empty(folder_));
    write_png8(folder_ / "full.png", noise);  // the same call succeeds once there is room
    EXPECT_EQ(read_rgb8(folder_ / "full.png").width(), 200);
}

}  // namespace
}  // namespace matchlight
