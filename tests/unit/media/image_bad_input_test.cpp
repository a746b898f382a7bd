// Every row of damaged or hostile still images: an error that names the file, or a counted repair.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "media/image_io.h"
#include "scratch_folder.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ImageBadInput : public ScratchFolder {
protected:
    std::string linear_error(const fs::path& path) {
        return error_of([&] { read_linear_rgb(path, warnings_); });
    }
    static std::string little_endian(std::int32_t value) {
        std::string bytes(4, '\0');
        for (int i = 0; i < 4; ++i) bytes[static_cast<std::size_t>(i)] = static_cast<char>(value >> (8 * i));
        return bytes;
    }
    static std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + little_endian(static_cast<std::int32_t>(value.size())) + value;
    }
    /// The header of a scanline EXR file with these windows and half-float channels, and nothing behind it.
    static std::string exr_header(const std::array<std::int32_t, 4>& window, int channels) {
        std::string list, box;
        for (int c = 0; c < channels; ++c) {
            list += (channels == 3 ? std::string(1, "BGR"[c]) : "c" + std::to_string(c)) + '\0';
            list += little_endian(1) + little_endian(0) + little_endian(1) + little_endian(1);
        }
        list += '\0';
        for (const std::int32_t edge : window) box += little_endian(edge);
        const std::string one("\0\0\x80\x3f", 4);
        std::string header("\x76\x2f\x31\x01\x02\0\0\0", 8);
        header += attribute("channels", "chlist", list) + attribute("compression", "compression", std::string(1, '\0'));
        header += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box);
        header +=
            attribute("lineOrder", "lineOrder", std::string(1, '\0')) + attribute("pixelAspectRatio", "float", one);
        header += attribute("screenWindowCenter", "v2f", std::string(8, '\0'));
        return header + attribute("screenWindowWidth", "float", one) + '\0';
    }
    fs::path small_exr(const std::string& name) {
        ImageF image(32, 16, 3);
        for (std::size_t i = 0; i < image.samples().size(); ++i)
            image.samples()[i] = static_cast<float>(i * 2654435761u % 1000) / 1000;
        write_exr(folder_ / name, 32, 16, {{"rgb", {"R", "G", "B"}, &image, true, {}}}, {});
        return folder_ / name;
    }
};

TEST_F(ImageBadInput, MissingEmptyFolderAndFifo) {
    EXPECT_THAT(linear_error(folder_ / "none.exr"), HasSubstr("no such file"));
    EXPECT_THAT(linear_error(write_bytes("zero.exr", "")), HasSubstr("zero bytes"));
    EXPECT_THAT(linear_error(folder_), HasSubstr("folder"));
    ASSERT_EQ(mkfifo((folder_ / "pipe.exr").c_str(), 0600), 0);
    EXPECT_THAT(linear_error(folder_ / "pipe.exr"), HasSubstr("not a regular file"));
    EXPECT_THAT(error_of([&] { read_rgb8(write_bytes("zero.png", "")); }), HasSubstr("zero.png"));
}

TEST_F(ImageBadInput, RandomBytes) {
    std::string noise(5000, '\0');
    unsigned state = 7;
    for (char& c : noise) c = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
    EXPECT_THAT(linear_error(write_bytes("noise.exr", noise)), HasSubstr("noise.exr"));
    EXPECT_THAT(error_of([&] { read_rgb8(write_bytes("noise.png", noise)); }), HasSubstr("noise.png"));
    EXPECT_THAT(linear_error(write_bytes("magic.exr", "\x76\x2f\x31\x01" + noise)), HasSubstr("magic.exr"));
    EXPECT_THAT(error_of([&] { read_rgb8(write_bytes("magic.png", "\x89PNG\r\n\x1a\n" + noise)); }),
                HasSubstr("magic.png"));
    EXPECT_THAT(error_of([&] { read_rgb8(write_bytes("list.png", "ffconcat version 1.0\nfile x.mp4\n")); }),
                HasSubstr("no picture"));
}

TEST_F(ImageBadInput, TruncatedExrAtAnyPlace) {
    const std::string whole = bytes_of(small_exr("whole.exr"));
    for (const double part : {0.02, 0.2, 0.5, 0.9, 0.999}) {
        const auto length = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
        EXPECT_THAT(linear_error(write_bytes("cut.exr", whole.substr(0, length))), HasSubstr("cut.exr")) << part;
    }
}

TEST_F(ImageBadInput, DamagedExrPixels) {
    std::string bytes = bytes_of(small_exr("whole.exr"));
    for (std::size_t i = bytes.size() - 600; i < bytes.size() - 100; ++i) bytes[i] = static_cast<char>(0xa5);
    EXPECT_THAT(linear_error(write_bytes("broken.exr", bytes)), HasSubstr("broken.exr"));
}

TEST_F(ImageBadInput, AbsurdExrHeaders) {
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    const std::pair<const char*, std::array<std::int32_t, 4>> windows[] = {
        {"huge", {0, 0, 999999, 999999}},
        {"overflow", {-most, -most, most, most}},
        {"inverted", {10, 10, 0, 0}},
        {"wide", {0, 0, 200000, 0}},
    };
    for (const auto& [name, window] : windows) {
        const fs::path path = write_bytes(std::string(name) + ".exr", exr_header(window, 3));
        EXPECT_THAT(linear_error(path), HasSubstr(name));
    }
    EXPECT_THAT(linear_error(write_bytes("many.exr", exr_header({0, 0, 15, 7}, 2000) + std::string(1000, '\0'))),
                HasSubstr("2000 channels"));
    EXPECT_THAT(linear_error(write_bytes("million.exr", exr_header({0, 0, 15, 7}, 1000000))), HasSubstr("million.exr"));
    // A sane header with nothing behind it.
    EXPECT_THAT(linear_error(write_bytes("bare.exr", exr_header({0, 0, 15, 7}, 3))), HasSubstr("bare.exr"));
}

TEST_F(ImageBadInput, NonFiniteSamplesAreRepairedAndCounted) {
    ImageF image(4, 2, 3, 0.5f);
    image.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
    image.at(1, 0, 1) = std::numeric_limits<float>::infinity();
    image.at(2, 0, 2) = -std::numeric_limits<float>::infinity();
    image.at(3, 1, 0) = 1e5f;
    image.at(3, 1, 1) = -2;
    write_exr(folder_ / "odd.exr", 4, 2, {{"rgb", {"R", "G", "B"}, &image, false, {}}}, {});
    const ImageF read = read_linear_rgb(folder_ / "odd.exr", warnings_);
    EXPECT_EQ(read.at(0, 0, 0), 0);
    EXPECT_EQ(read.at(1, 0, 1), 65504);
    EXPECT_EQ(read.at(2, 0, 2), -65504);
    EXPECT_EQ(read.at(3, 1, 0), 1e5f);  // a bright sun is kept
    EXPECT_EQ(read.at(3, 1, 1), -2);
    EXPECT_EQ(warned("1 samples are NaN"), 1);
    EXPECT_EQ(warned("2 samples are infinite"), 1);
    EXPECT_EQ(warned("1 samples lie beyond 65504"), 1);
}

TEST_F(ImageBadInput, NoColourChannels) {
    ImageF depth(4, 2, 1, 1.0f);
    write_exr(folder_ / "z.exr", 4, 2, {{"depth", {"Z"}, &depth, false, {}}}, {});
    EXPECT_THAT(linear_error(folder_ / "z.exr"), HasSubstr("neither RGB nor luminance"));
}

TEST_F(ImageBadInput, RadianceHeaders) {
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
    EXPECT_THAT(linear_error(write_bytes("huge.hdr", head + "-Y 1000000 +X 1000000\n")), HasSubstr("1000000"));
    EXPECT_THAT(linear_error(write_bytes("inverted.hdr", head + "-Y -5 +X 10\n")), HasSubstr("inverted.hdr"));
    EXPECT_THAT(linear_error(write_bytes("bare.hdr", head + "-Y 64 +X 128\n")), HasSubstr("bare.hdr"));
    // A run that is longer than its scanline.
    EXPECT_THAT(linear_error(write_bytes("rle.hdr", head + "-Y 1 +X 16\n" + std::string("\x02\x02\x00\x10\xff\x01", 6) +
                                                        std::string(200, '\x7f'))),
                HasSubstr("rle.hdr"));
    std::string flat = head + "-Y 2 +X 4\n";
    for (int i = 0; i < 8; ++i) flat += std::string("\x80\x40\x20\x81", 4);
    const ImageF read = read_linear_rgb(write_bytes("flat.hdr", flat), warnings_);
    EXPECT_NEAR(read.at(3, 1, 0), 1.0, 0.01);  // mantissa 128/256 · 2^(129−128), to the format's 8 bits
    EXPECT_NEAR(read.at(3, 1, 2), 0.25, 0.01);
}

TEST_F(ImageBadInput, TruncatedPictures) {
    Image8 noise(64, 64, 3);
    unsigned state = 1;
    for (std::uint8_t& sample : noise.samples())
        sample = static_cast<std::uint8_t>((state = state * 1664525 + 1) >> 24);
    write_png8(folder_ / "whole.png", noise);
    const std::string whole = bytes_of(folder_ / "whole.png");
    for (const std::size_t length : {std::size_t{20}, whole.size() / 2, whole.size() - 200})
        EXPECT_THAT(error_of([&] { read_rgb8(write_bytes("cut.png", whole.substr(0, length))); }), HasSubstr("cut.png"))
            << length;
}

TEST_F(ImageBadInput, PictureBombs) {
    // Whole PNG chunks with correct CRCs that claim 65536 × 65536 pixels.
    const std::string bomb(
        "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\x01\0\0\0\x01\0\0\x08\x02\0\0\0\xe3\xe6\xa7\xb4\0\0\0\0IDAT\x35\xaf\x06\x1e"
        "\0\0\0\0IEND\xae\x42\x60\x82",
        57);
    EXPECT_THAT(error_of([&] { read_rgb8(write_bytes("bomb.png", bomb)); }), HasSubstr("65536"));
    EXPECT_THAT(linear_error(small_exr("probe.exr")), "");
    EXPECT_THAT(error_of([&] { read_rgb8(folder_ / "probe.exr"); }), HasSubstr("not a picture"));
}

}  // namespace
}  // namespace matchlight
