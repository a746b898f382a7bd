// Plate frames against formulas in double precision, and the rule that what nothing touches does not change.
#include "media/plate.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "media/av_pointers.h"
#include "media/plate_format.h"
#include "media/sample_layout.h"

extern "C" {
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
}

namespace matchlight {
namespace {

constexpr int width = 37, height = 22;  // odd and even, to meet incomplete chroma blocks
const Region whole{0, 0, width, height};

std::shared_ptr<AVFrame> random_samples(AVPixelFormat format, int w, int h, unsigned seed) {
    std::shared_ptr<AVFrame> frame = allocated_frame(w, h, format);
    const SampleLayout layout = *SampleLayout::of(format);
    std::mt19937 random(seed);
    for (int c = 0; c < layout.colours + (layout.has_alpha ? 1 : 0); ++c) {
        const int most = layout.component[static_cast<std::size_t>(c)].max();
        for (int y = 0; y < layout.height_of(c, *frame); ++y) {
            for (int x = 0; x < layout.width_of(c, *frame); ++x) {
                // Chroma in the middle third keeps most colours inside the gamut.
                const double part = std::uniform_real_distribution<>(layout.is_chroma(c) ? 0.4 : 0.1,
                                                                     layout.is_chroma(c) ? 0.6 : 0.9)(random);
                write_sample(layout, *frame, c, x, y, static_cast<int>(part * most));
            }
        }
    }
    return frame;
}

PlateFrame random_plate(AVPixelFormat format, const FootageOptions& options = {}, int rotation_deg = 0,
                        AVChromaLocation siting = AVCHROMA_LOC_UNSPECIFIED, unsigned seed = 1) {
    std::shared_ptr<AVFrame> frame = random_samples(format, width, height, seed);
    frame->chroma_location = siting;
    PlateFormat plate_format = plate_format_of(*frame, rotation_deg, options, "test");
    return {std::move(frame), std::move(plate_format), 0, 0};
}

int sample_at(const AVFrame& frame, int component, int x, int y) {
    const SampleLayout layout = *SampleLayout::of(static_cast<AVPixelFormat>(frame.format));
    std::uint16_t sample = 0;
    read_samples(layout, frame, {component, x, y, 1}, &sample);
    return sample;
}

/// The (component, x, y) of every sample that differs, alpha included.
std::set<std::array<int, 3>> changed_samples(const AVFrame& a, const AVFrame& b) {
    const SampleLayout layout = *SampleLayout::of(static_cast<AVPixelFormat>(a.format));
    std::set<std::array<int, 3>> changed;
    for (int c = 0; c < layout.colours + (layout.has_alpha ? 1 : 0); ++c) {
        for (int y = 0; y < layout.height_of(c, a); ++y) {
            for (int x = 0; x < layout.width_of(c, a); ++x) {
                if (sample_at(a, c, x, y) != sample_at(b, c, x, y)) changed.insert({c, x, y});
            }
        }
    }
    return changed;
}

/// Every byte of every row, unused bits of packed words too.
bool same_bytes(const AVFrame& a, const AVFrame& b) {
    for (int plane = 0; plane < 4 && a.data[plane] != nullptr; ++plane) {
        const int rows = plane == 0 || plane == 3
                             ? a.height
                             : SampleLayout::of(static_cast<AVPixelFormat>(a.format))->height_of(1, a);
        for (int y = 0; y < rows; ++y) {
            const int bytes = av_image_get_linesize(static_cast<AVPixelFormat>(a.format), a.width, plane);
            if (std::memcmp(a.data[plane] + y * a.linesize[plane], b.data[plane] + y * b.linesize[plane],
                            static_cast<std::size_t>(bytes)) != 0)
                return false;
        }
    }
    return true;
}

// ---- reading -----------------------------------------------------------------------------------------------------

struct Reference {
    double kr, kb;
};

/// R'G'B' of stored pixel (x, y) by the text of the standards, in double: an implementation of its own.
std::array<double, 3> reference_rgb(const PlateFrame& plate, const Reference& k, double site_x, double site_y, int x,
                                    int y) {
    const AVFrame& frame = *plate.samples();
    const SampleLayout layout = *SampleLayout::of(static_cast<AVPixelFormat>(frame.format));
    const double top = std::pow(2, layout.depth()) - 1, unit = std::pow(2, layout.depth() - 8);
    const bool full = plate.format().range == ColorRange::full;
    const double half = std::pow(2, layout.depth() - 1);
    const auto luma = [&](int v) { return full ? v / top : (v - 16 * unit) / (219 * unit); };
    const auto chroma = [&](int v) { return full ? (v - half) / top : (v - half) / (224 * unit); };
    const auto at = [&](int c) {
        const int sx = 1 << layout.log2_chroma_width, sy = 1 << layout.log2_chroma_height;
        const double u = (x - site_x) / sx, v = (y - site_y) / sy;
        double sum = 0;
        for (int j = 0; j < 2; ++j) {
            for (int i = 0; i < 2; ++i) {
                const double wx = i == 0 ? 1 - (u - std::floor(u)) : u - std::floor(u);
                const double wy = j == 0 ? 1 - (v - std::floor(v)) : v - std::floor(v);
                const int cx = std::clamp(static_cast<int>(std::floor(u)) + i, 0, layout.width_of(c, frame) - 1);
                const int cy = std::clamp(static_cast<int>(std::floor(v)) + j, 0, layout.height_of(c, frame) - 1);
                sum += wx * wy * chroma(sample_at(frame, c, cx, cy));
            }
        }
        return sum;
    };
    const double l = luma(sample_at(frame, 0, x, y)), cb = at(1), cr = at(2);
    const double r = l + 2 * (1 - k.kr) * cr, b = l + 2 * (1 - k.kb) * cb;
    return {r, (l - k.kr * r - k.kb * b) / (1 - k.kr - k.kb), b};
}

struct Reading {
    AVPixelFormat format;
    ColorMatrix matrix;
    ColorRange range;
    AVChromaLocation siting;
    double site_x, site_y;  // in luma samples from the block's first
};

class PlateReading : public testing::TestWithParam<Reading> {};

TEST_P(PlateReading, AgreesWithTheStandardsInDouble) {
    const Reading& p = GetParam();
    FootageOptions options;
    options.matrix = p.matrix;
    options.range = p.range;
    const PlateFrame plate = random_plate(p.format, options, 0, p.siting);
    const Reference k = p.matrix == ColorMatrix::bt601   ? Reference{0.299, 0.114}
                        : p.matrix == ColorMatrix::bt709 ? Reference{0.2126, 0.0722}
                                                         : Reference{0.2627, 0.0593};
    const ImageF code = plate.rgb_code(whole);
    const Image8 eight = plate.rgb8(whole);
    const Image16 sixteen = plate.rgb16(whole);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto expected = reference_rgb(plate, k, p.site_x, p.site_y, x, y);
            for (int c = 0; c < 3; ++c) {
                // Float has 24 bits; a handful of operations on values near 1 stay within 1e-6.
                ASSERT_NEAR(code.at(x, y, c), expected[static_cast<std::size_t>(c)], 1e-6) << x << ' ' << y << ' ' << c;
                const float clipped = std::clamp(code.at(x, y, c), 0.0f, 1.0f);
                ASSERT_EQ(eight.at(x, y, c), std::nearbyint(clipped * 255.0f));
                ASSERT_EQ(sixteen.at(x, y, c), std::nearbyint(clipped * 65535.0f));
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Formats, PlateReading,
    testing::Values(
        Reading{AV_PIX_FMT_YUV420P, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_UNSPECIFIED, 0, 0.5},
        Reading{AV_PIX_FMT_YUV420P, ColorMatrix::bt601, ColorRange::full, AVCHROMA_LOC_UNSPECIFIED, 0.5, 0.5},
        Reading{AV_PIX_FMT_YUV420P, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_TOPLEFT, 0, 0},
        Reading{AV_PIX_FMT_YUV420P, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_BOTTOM, 0.5, 1},
        Reading{AV_PIX_FMT_YUV420P10LE, ColorMatrix::bt2020, ColorRange::limited, AVCHROMA_LOC_TOPLEFT, 0, 0},
        Reading{AV_PIX_FMT_YUV420P10BE, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0.5},
        Reading{AV_PIX_FMT_P010LE, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0.5},
        Reading{AV_PIX_FMT_NV12, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0.5},
        Reading{AV_PIX_FMT_NV21, ColorMatrix::bt601, ColorRange::limited, AVCHROMA_LOC_CENTER, 0.5, 0.5},
        Reading{AV_PIX_FMT_YUV422P, ColorMatrix::bt601, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0},
        Reading{AV_PIX_FMT_YUYV422, ColorMatrix::bt601, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0},
        Reading{AV_PIX_FMT_UYVY422, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0},
        Reading{AV_PIX_FMT_YUV440P, ColorMatrix::bt601, ColorRange::full, AVCHROMA_LOC_CENTER, 0, 0.5},
        Reading{AV_PIX_FMT_YUV411P, ColorMatrix::bt601, ColorRange::limited, AVCHROMA_LOC_LEFT, 0, 0},
        Reading{AV_PIX_FMT_YUV410P, ColorMatrix::bt601, ColorRange::limited, AVCHROMA_LOC_CENTER, 1.5, 1.5},
        Reading{AV_PIX_FMT_YUV444P, ColorMatrix::bt709, ColorRange::full, AVCHROMA_LOC_UNSPECIFIED, 0, 0},
        Reading{AV_PIX_FMT_YUV444P16LE, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_UNSPECIFIED, 0, 0},
        Reading{AV_PIX_FMT_YUVA444P10LE, ColorMatrix::bt709, ColorRange::limited, AVCHROMA_LOC_UNSPECIFIED, 0, 0}));

TEST(Plate, KnownColoursOfBt709AndBt601) {
    struct Bar {
        std::array<int, 3> ycc;
        std::array<double, 3> rgb;
    };
    // 100 % bars at 8 bits, limited range: the integer codes that the standards' formulas round to.
    const std::vector<std::pair<ColorMatrix, Bar>> bars = {
        {ColorMatrix::bt709, {{235, 128, 128}, {1, 1, 1}}}, {ColorMatrix::bt709, {{16, 128, 128}, {0, 0, 0}}},
        {ColorMatrix::bt709, {{63, 102, 240}, {1, 0, 0}}},  {ColorMatrix::bt709, {{173, 42, 26}, {0, 1, 0}}},
        {ColorMatrix::bt709, {{32, 240, 118}, {0, 0, 1}}},  {ColorMatrix::bt601, {{81, 90, 240}, {1, 0, 0}}},
        {ColorMatrix::bt601, {{145, 54, 34}, {0, 1, 0}}},   {ColorMatrix::bt601, {{41, 240, 110}, {0, 0, 1}}}};
    for (const auto& [matrix, bar] : bars) {
        std::shared_ptr<AVFrame> frame = allocated_frame(8, 8, AV_PIX_FMT_YUV420P);
        for (int plane = 0; plane < 3; ++plane) {
            for (int y = 0; y < (plane == 0 ? 8 : 4); ++y)
                std::memset(frame->data[plane] + y * frame->linesize[plane], bar.ycc[static_cast<std::size_t>(plane)],
                            plane == 0 ? 8 : 4);
        }
        FootageOptions options;
        options.matrix = matrix;
        const PlateFrame plate(frame, plate_format_of(*frame, 0, options, "test"), 0, 0);
        const ImageF code = plate.rgb_code({3, 3, 1, 1});
        for (int c = 0; c < 3; ++c)  // half a code of each sample, times the matrix' largest coefficient
            EXPECT_NEAR(code.at(0, 0, c), bar.rgb[static_cast<std::size_t>(c)], 0.0075);
    }
}

TEST(Plate, GuessesTheMatrixByTheSizeAsPlayersDo) {
    const auto format_of_size = [](int w, int h) {
        return plate_format_of(*allocated_frame(w, h, AV_PIX_FMT_YUV420P), 0, {}, "test");
    };
    EXPECT_EQ(format_of_size(720, 576).matrix, ColorMatrix::bt601);
    EXPECT_EQ(format_of_size(1280, 720).matrix, ColorMatrix::bt709);
    EXPECT_TRUE(format_of_size(1280, 720).matrix_guessed);
    const auto frame = allocated_frame(720, 576, AV_PIX_FMT_YUV420P);
    frame->colorspace = AVCOL_SPC_BT709;
    EXPECT_EQ(plate_format_of(*frame, 0, {}, "test").matrix, ColorMatrix::bt709);
    EXPECT_FALSE(plate_format_of(*frame, 0, {}, "test").matrix_guessed);
    frame->color_trc = AVCOL_TRC_ARIB_STD_B67;
    EXPECT_EQ(plate_format_of(*frame, 0, {}, "test").transfer, Transfer::hlg);
    frame->color_trc = AVCOL_TRC_SMPTE2084;
    EXPECT_EQ(plate_format_of(*frame, 0, {}, "test").transfer, Transfer::pq);
    frame->color_trc = AVCOL_TRC_BT709;
    EXPECT_EQ(plate_format_of(*frame, 0, {}, "test").transfer, Transfer::camera);
    EXPECT_EQ(plate_format_of(*allocated_frame(64, 64, AV_PIX_FMT_YUVJ420P), 0, {}, "test").range, ColorRange::full);
}

TEST(Plate, RgbSamplesAreReadAsTheyAre) {
    for (const AVPixelFormat format : {AV_PIX_FMT_GBRP, AV_PIX_FMT_RGB24, AV_PIX_FMT_BGR24, AV_PIX_FMT_RGBA,
                                       AV_PIX_FMT_BGRA, AV_PIX_FMT_BGR0, AV_PIX_FMT_ARGB}) {
        const PlateFrame plate = random_plate(format);
        const Image8 eight = plate.rgb8(whole);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < 3; ++c)
                    ASSERT_EQ(eight.at(x, y, c), sample_at(*plate.samples(), c, x, y)) << av_get_pix_fmt_name(format);
            }
        }
    }
    for (const AVPixelFormat format : {AV_PIX_FMT_RGB48LE, AV_PIX_FMT_RGB48BE, AV_PIX_FMT_GBRP16LE}) {
        const PlateFrame plate = random_plate(format);
        const Image16 sixteen = plate.rgb16(whole);
        for (int x = 0; x < width; ++x) ASSERT_EQ(sixteen.at(x, 7, 1), sample_at(*plate.samples(), 1, x, 7));
    }
    // Byte order by hand, once: R is the first byte of rgb24, the third of bgra.
    const PlateFrame rgb = random_plate(AV_PIX_FMT_RGB24), bgra = random_plate(AV_PIX_FMT_BGRA);
    EXPECT_EQ(rgb.rgb8({5, 3, 1, 1}).at(0, 0, 0), rgb.samples()->data[0][3 * rgb.samples()->linesize[0] + 15]);
    EXPECT_EQ(bgra.rgb8({5, 3, 1, 1}).at(0, 0, 0), bgra.samples()->data[0][3 * bgra.samples()->linesize[0] + 22]);
}

TEST(Plate, GreyIsLumaOrGreen) {
    const PlateFrame limited = random_plate(AV_PIX_FMT_YUV420P);
    EXPECT_FLOAT_EQ(limited.gray_code(whole).at(9, 5), (sample_at(*limited.samples(), 0, 9, 5) - 16) / 219.0f);
    const PlateFrame green = random_plate(AV_PIX_FMT_GBRP);
    EXPECT_FLOAT_EQ(green.gray_code(whole).at(9, 5), sample_at(*green.samples(), 1, 9, 5) / 255.0f);
    const PlateFrame grey = random_plate(AV_PIX_FMT_GRAY8);  // full range unless tagged
    EXPECT_FLOAT_EQ(grey.rgb_code(whole).at(9, 5, 2), sample_at(*grey.samples(), 0, 9, 5) / 255.0f);
}

TEST(Plate, ARegionIsACutOfTheWhole) {
    for (const AVPixelFormat format : {AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUV411P, AV_PIX_FMT_P010LE, AV_PIX_FMT_RGB24}) {
        for (const int rotation : {0, 90, 180, 270}) {
            const PlateFrame plate = random_plate(format, {}, rotation);
            const ImageF all = plate.rgb_code({0, 0, plate.format().width, plate.format().height});
            for (const Region& region : {Region{0, 0, 1, 1}, Region{3, 5, 7, 6}, Region{4, 2, 16, 9},
                                         Region{plate.format().width - 5, plate.format().height - 3, 5, 3}}) {
                const ImageF part = plate.rgb_code(region);
                for (int y = 0; y < region.height; ++y) {
                    for (int x = 0; x < region.width; ++x)
                        ASSERT_EQ(part.at(x, y, 0), all.at(region.x + x, region.y + y, 0));
                }
            }
        }
    }
}

TEST(Plate, RotationMapsCoordinates) {
    const PlateFrame stored = random_plate(AV_PIX_FMT_YUV420P);
    const ImageF upright = stored.rgb_code(whole);
    // A quarter turn clockwise puts the left column on top: its lowest pixel becomes the first.
    const PlateFrame quarter = random_plate(AV_PIX_FMT_YUV420P, {}, 90);
    ASSERT_EQ(quarter.format().width, height);
    ASSERT_EQ(quarter.format().height, width);
    const ImageF turned = quarter.rgb_code({0, 0, height, width});
    EXPECT_EQ(turned.at(0, 0, 0), upright.at(0, height - 1, 0));
    EXPECT_EQ(turned.at(height - 1, 0, 0), upright.at(0, 0, 0));
    EXPECT_EQ(turned.at(4, 9, 1), upright.at(9, height - 1 - 4, 1));
    const ImageF half = random_plate(AV_PIX_FMT_YUV420P, {}, 180).rgb_code(whole);
    EXPECT_EQ(half.at(4, 9, 1), upright.at(width - 1 - 4, height - 1 - 9, 1));
    const ImageF three = random_plate(AV_PIX_FMT_YUV420P, {}, 270).rgb_code({0, 0, height, width});
    EXPECT_EQ(three.at(0, 0, 0), upright.at(width - 1, 0, 0));
    EXPECT_EQ(three.at(4, 9, 1), upright.at(width - 1 - 9, 4, 1));
}

// ---- writing -----------------------------------------------------------------------------------------------------

struct Writing {
    AVPixelFormat format;
    int rotation_deg;
};

class PlateWriting : public testing::TestWithParam<Writing> {
protected:
    PlateFrame plate() const { return random_plate(GetParam().format, {}, GetParam().rotation_deg); }
    static Region bounds(const PlateFrame& plate) { return {0, 0, plate.format().width, plate.format().height}; }
};

TEST_P(PlateWriting, AnEmptyMaskChangesNothing) {
    PlateFrame frame = plate();
    const std::shared_ptr<AVFrame> before = frame.shared_samples();
    const Region region = bounds(frame);
    frame.write_rgb_code(region, ImageF(region.width, region.height, 3, 0.3f),
                         Image8(region.width, region.height, 1, 0));
    EXPECT_TRUE(same_bytes(*before, *frame.samples()));
}

TEST_P(PlateWriting, WhatIsWrittenBackAsItWasReadChangesNothing) {
    PlateFrame frame = plate();
    const std::shared_ptr<AVFrame> before = frame.shared_samples();
    for (const Region& region : {bounds(frame), Region{3, 5, 7, 6}, Region{1, 1, 1, 1}}) {
        frame.write_rgb_code(region, frame.rgb_code(region), Image8(region.width, region.height, 1, 1));
        EXPECT_TRUE(same_bytes(*before, *frame.samples()));
    }
}

TEST_P(PlateWriting, OnlyTouchedPixelsAndTheirBlocksChange) {
    PlateFrame frame = plate();
    const std::shared_ptr<AVFrame> before = frame.shared_samples();
    const Region region{2, 3, 11, 13};
    Image8 touched(region.width, region.height, 1, 0);
    for (const auto& [x, y] : {std::pair{0, 0}, {5, 4}, {6, 4}, {10, 12}}) touched.at(x, y) = 255;
    frame.write_rgb_code(region, ImageF(region.width, region.height, 3, 0.02f), touched);

    // Which stored samples may differ, found through the displayed picture: pixels by a one-pixel plate of their own.
    const SampleLayout layout = *SampleLayout::of(GetParam().format);
    const int w = before->width, h = before->height;
    std::set<std::array<int, 3>> allowed;
    std::set<std::array<int, 3>> touched_luma;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            if (touched.at(x, y) == 0) continue;
            const int dx = region.x + x, dy = region.y + y;
            int sx = dx, sy = dy;
            if (GetParam().rotation_deg == 90) sx = dy, sy = h - 1 - dx;
            if (GetParam().rotation_deg == 180) sx = w - 1 - dx, sy = h - 1 - dy;
            if (GetParam().rotation_deg == 270) sx = w - 1 - dy, sy = dx;
            for (int c = 0; c < layout.colours; ++c) {
                allowed.insert(layout.is_chroma(c)
                                   ? std::array{c, sx >> layout.log2_chroma_width, sy >> layout.log2_chroma_height}
                                   : std::array{c, sx, sy});
            }
            touched_luma.insert({0, sx, sy});
        }
    }
    const auto changed = changed_samples(*before, *frame.samples());
    for (const auto& sample : changed)
        EXPECT_TRUE(allowed.contains(sample)) << sample[0] << ' ' << sample[1] << ' ' << sample[2];
    for (const auto& sample : touched_luma)  // 0.02 is darker than every random sample
        EXPECT_TRUE(changed.contains(sample)) << sample[1] << ' ' << sample[2];
}

TEST_P(PlateWriting, AnEvenColourIsReadBack) {
    PlateFrame frame = plate();
    const Region region = bounds(frame);
    ImageF colour(region.width, region.height, 3);
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            colour.at(x, y, 0) = 0.75f;
            colour.at(x, y, 1) = 0.5f;
            colour.at(x, y, 2) = 0.25f;
        }
    }
    frame.write_rgb_code(region, colour, Image8(region.width, region.height, 1, 1));
    const SampleLayout layout = *SampleLayout::of(GetParam().format);
    const ImageF read = frame.rgb_code(region);
    // Half a step of every sample that takes part: luma plus chroma times at most 1.8814 (BT.2020's largest is not
    // used here; BT.601's is 1.772), over the shortest scale of the format.
    const int shallow = std::min({layout.component[0].depth, layout.component[1].depth, layout.component[2].depth});
    const double step = 1 / (219 * std::pow(2, shallow - 8));
    const double grey = 0.299 * 0.75 + 0.587 * 0.5 + 0.114 * 0.25;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(read.at(x, y, c), layout.colours == 1 ? grey : colour.at(x, y, c),
                            layout.colours == 1 ? 0.5 / ((1 << layout.depth()) - 1) + 1e-6 : 1.5 * step);
        }
    }
}

TEST_P(PlateWriting, OtherHoldersOfTheSamplesSeeNoChange) {
    PlateFrame frame = plate();
    const PlateFrame copy = frame;
    const Image8 before = copy.rgb8(bounds(copy));
    frame.write_rgb_code({0, 0, 8, 8}, ImageF(8, 8, 3, 0.0f), Image8(8, 8, 1, 1));
    const Image8 after = copy.rgb8(bounds(copy));
    EXPECT_TRUE(std::ranges::equal(before.samples(), after.samples()));
}

INSTANTIATE_TEST_SUITE_P(
    Formats, PlateWriting,
    testing::Values(Writing{AV_PIX_FMT_YUV420P, 0}, Writing{AV_PIX_FMT_YUV420P, 90}, Writing{AV_PIX_FMT_YUV420P, 180},
                    Writing{AV_PIX_FMT_YUV420P, 270}, Writing{AV_PIX_FMT_YUVJ420P, 0}, Writing{AV_PIX_FMT_YUV422P, 0},
                    Writing{AV_PIX_FMT_YUV444P, 0}, Writing{AV_PIX_FMT_YUV440P, 0}, Writing{AV_PIX_FMT_YUV411P, 0},
                    Writing{AV_PIX_FMT_YUV410P, 0}, Writing{AV_PIX_FMT_YUV420P10LE, 0},
                    Writing{AV_PIX_FMT_YUV420P10BE, 0}, Writing{AV_PIX_FMT_YUV422P12LE, 90},
                    Writing{AV_PIX_FMT_YUV420P16LE, 0}, Writing{AV_PIX_FMT_NV12, 0}, Writing{AV_PIX_FMT_NV21, 0},
                    Writing{AV_PIX_FMT_P010LE, 0}, Writing{AV_PIX_FMT_P016LE, 0}, Writing{AV_PIX_FMT_YUYV422, 0},
                    Writing{AV_PIX_FMT_UYVY422, 0}, Writing{AV_PIX_FMT_Y210LE, 0}, Writing{AV_PIX_FMT_YUVA420P, 0},
                    Writing{AV_PIX_FMT_YUVA444P10LE, 270}, Writing{AV_PIX_FMT_GRAY8, 0},
                    Writing{AV_PIX_FMT_GRAY16LE, 0}, Writing{AV_PIX_FMT_YA8, 0}, Writing{AV_PIX_FMT_GBRP, 0},
                    Writing{AV_PIX_FMT_GBRP10LE, 180}, Writing{AV_PIX_FMT_GBRAP, 0}, Writing{AV_PIX_FMT_GBRP16LE, 0},
                    Writing{AV_PIX_FMT_RGB24, 0}, Writing{AV_PIX_FMT_BGR24, 90}, Writing{AV_PIX_FMT_RGBA, 0},
                    Writing{AV_PIX_FMT_BGR0, 0}, Writing{AV_PIX_FMT_RGB48LE, 0}, Writing{AV_PIX_FMT_RGB48BE, 0},
                    Writing{AV_PIX_FMT_X2RGB10LE, 0}),
    [](const testing::TestParamInfo<Writing>& test) {
        return std::string(av_get_pix_fmt_name(test.param.format)) + "_" + std::to_string(test.param.rotation_deg);
    });

TEST(Plate, WrittenChromaLiesWhereItsSiteIs) {
    // A horizontal ramp of colour is written and read back: any shift between filter down and interpolation up would
    // show as a constant error. Half a luma sample of shift would be 0.5 · 0.02 = 0.01.
    for (const AVChromaLocation siting : {AVCHROMA_LOC_LEFT, AVCHROMA_LOC_CENTER, AVCHROMA_LOC_TOPLEFT}) {
        FootageOptions options;
        options.matrix = ColorMatrix::bt709;
        PlateFrame frame = random_plate(AV_PIX_FMT_YUV420P16LE, options, 0, siting);
        ImageF ramp(width, height, 3);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                ramp.at(x, y, 0) = 0.1f + 0.02f * static_cast<float>(x);
                ramp.at(x, y, 1) = 0.5f;
                ramp.at(x, y, 2) = 0.2f + 0.02f * static_cast<float>(y);
            }
        }
        // From black, so that every pixel changes and none keeps detail of the old chroma.
        frame.write_rgb_code(whole, ImageF(width, height, 3, 0.0f), Image8(width, height, 1, 1));
        frame.write_rgb_code(whole, ramp, Image8(width, height, 1, 1));
        const ImageF read = frame.rgb_code(whole);
        for (int y = 4; y < height - 4; ++y) {
            for (int x = 4; x < width - 4; ++x) {
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(read.at(x, y, c), ramp.at(x, y, c), 1e-4) << siting;
            }
        }
    }
}

TEST(Plate, NothingOfThePlatesColourShowsThroughWhatReplacedIt) {
    // Random chroma under an opaque black object: inside it, away from its rim, only the object's colour may be left.
    // No random pixel is as dark as within eight codes of it.
    PlateFrame frame = random_plate(AV_PIX_FMT_YUV420P);
    const Region region{6, 6, 16, 12};
    frame.write_rgb_code(region, ImageF(region.width, region.height, 3, 0.0f),
                         Image8(region.width, region.height, 1, 1));
    for (int cy = 4; cy < 8; ++cy) {
        for (int cx = 4; cx < 10; ++cx) {
            EXPECT_EQ(sample_at(*frame.samples(), 1, cx, cy), 128);
            EXPECT_EQ(sample_at(*frame.samples(), 2, cx, cy), 128);
        }
    }
}

TEST(Plate, NonFiniteCodesAreWrittenAsBlackOrWhite) {
    PlateFrame frame = random_plate(AV_PIX_FMT_GBRP);
    ImageF odd(2, 1, 3, std::numeric_limits<float>::quiet_NaN());
    for (int c = 0; c < 3; ++c) odd.at(1, 0, c) = std::numeric_limits<float>::infinity();
    frame.write_rgb_code({0, 0, 2, 1}, odd, Image8(2, 1, 1, 1));
    EXPECT_EQ(sample_at(*frame.samples(), 0, 0, 0), 0);
    EXPECT_EQ(sample_at(*frame.samples(), 0, 1, 0), 255);
}

}  // namespace
}  // namespace matchlight
