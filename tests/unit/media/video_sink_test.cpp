// Encoding: samples, time stamps, tags and sound arrive as the footage had them.
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <malloc.h>

#include "file_size_limit.h"
#include "media/frame_sink.h"
#include "media/image_io.h"
#include "media/plate_format.h"
#include "media/sample_layout.h"
#include "scratch_folder.h"
#include "test_clip.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class VideoSinkTest : public ScratchFolder {
protected:
    struct Span {
        std::int64_t first = 0, last = 1 << 30;
    };
    /// Source to sink, nothing touched.
    void transcode(const fs::path& from, const fs::path& to, const VideoOptions& options) {
        transcode(from, to, options, Span{});
    }
    void transcode(const fs::path& from, const fs::path& to, const VideoOptions& options, const Span& span) {
        const auto source = FrameSource::open(from, {}, warnings_);
        VideoSink sink(to, source->info(), options, warnings_);
        source->seek(span.first);
        for (auto frame = source->next(); frame && frame->index() <= span.last; frame = source->next())
            sink.write(*frame);
        sink.finish();
    }
    /// All frames of two videos have the same samples and times.
    void expect_equal(const fs::path& a, const fs::path& b) {
        const auto left = FrameSource::open(a, {}, warnings_), right = FrameSource::open(b, {}, warnings_);
        EXPECT_EQ(left->info().frame_count, right->info().frame_count);
        EXPECT_EQ(left->info().format.width, right->info().format.width);
        EXPECT_EQ(left->info().format.matrix, right->info().format.matrix);
        EXPECT_EQ(left->info().format.range, right->info().format.range);
        EXPECT_EQ(left->info().format.transfer, right->info().format.transfer);
        EXPECT_EQ(left->info().format.siting, right->info().format.siting);
        EXPECT_EQ(left->info().format.rotation_deg, right->info().format.rotation_deg);
        EXPECT_EQ(left->info().variable_frame_rate, right->info().variable_frame_rate);
        EXPECT_EQ(left->info().sample_aspect.numerator, right->info().sample_aspect.numerator);
        while (const auto frame = left->next()) {
            const auto other = right->next();
            ASSERT_TRUE(other) << frame->index();
            EXPECT_TRUE(same_samples(*frame->samples(), *other->samples())) << "frame " << frame->index();
            EXPECT_NEAR(frame->time_s(), other->time_s(), 0.00101) << "frame " << frame->index();  // Matroska's ms
        }
        EXPECT_FALSE(right->next());
    }
    static VideoOptions lossless(VideoCodec codec) {
        VideoOptions options;
        options.codec = codec;
        options.crf = 0;
        options.preset = "ultrafast";
        return options;
    }
    template <class Action>
    std::string failure(const Action& action) {
        return error_of(action);
    }
};

struct Copy {
    const char* name;
    const char* from;
    AVPixelFormat format;
    int width, height;
    VideoCodec codec;
    const char* to;
    bool variable = false;
    int rotation_deg = 0;
};

class LosslessCopy : public VideoSinkTest, public testing::WithParamInterface<Copy> {};

TEST_P(LosslessCopy, EqualsTheFootageBitForBit) {
    const Copy& p = GetParam();
    TestClip clip;
    if (std::string(p.from).ends_with("mkv")) {
        clip.encoder = "ffv1";
        clip.options.clear();
    }
    clip.pixel_format = p.format;
    clip.width = p.width;
    clip.height = p.height;
    clip.rotation_deg = p.rotation_deg;
    clip.sample_aspect = {4, 3};
    if (p.variable) {
        clip.time_base = {1, 1000};
        clip.pts = {0, 33, 67, 150, 183, 400, 417, 433, 700, 733};
    }
    write_clip(clip, folder_ / p.from);
    transcode(folder_ / p.from, folder_ / p.to, lossless(p.codec));
    expect_equal(folder_ / p.from, folder_ / p.to);
    EXPECT_TRUE(warnings_.empty()) << warnings_.entries().front().text;
}

INSTANTIATE_TEST_SUITE_P(
    Codecs, LosslessCopy,
    testing::Values(
        Copy{"H264", "a.mp4", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::h264, "b.mp4"},
        Copy{"H264Matroska", "a.mp4", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::h264, "b.mkv"},
        Copy{"H264TenBit", "a.mp4", AV_PIX_FMT_YUV420P10LE, 64, 48, VideoCodec::h264, "b.mov"},
        Copy{"H264FullChroma", "a.mp4", AV_PIX_FMT_YUV444P, 63, 47, VideoCodec::h264, "b.mp4"},
        Copy{"H264Variable", "a.mp4", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::h264, "b.mp4", true},
        Copy{"H264Turned", "a.mp4", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::h264, "b.mp4", false, 90},
        Copy{"H264TurnedThreeQuarters", "a.mov", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::h264, "b.mov", false, 270},
        Copy{"H265", "a.mp4", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::h265, "b.mp4"},
        Copy{"H265TenBitVariable", "a.mp4", AV_PIX_FMT_YUV422P10LE, 64, 48, VideoCodec::h265, "b.mp4", true},
        Copy{"Ffv1Odd", "a.mkv", AV_PIX_FMT_YUV420P, 641, 361, VideoCodec::ffv1, "b.mkv"},
        Copy{"Ffv1Variable", "a.mp4", AV_PIX_FMT_YUV420P, 64, 48, VideoCodec::ffv1, "b.mkv", true},
        Copy{"Ffv1SixteenBit", "a.mkv", AV_PIX_FMT_YUV422P16LE, 64, 48, VideoCodec::ffv1, "b.mkv"},
        Copy{"Ffv1Alpha", "a.mkv", AV_PIX_FMT_YUVA444P, 64, 48, VideoCodec::ffv1, "b.mkv"},
        Copy{"Ffv1Rgb", "a.mkv", AV_PIX_FMT_BGR0, 65, 47, VideoCodec::ffv1, "b.mkv"},
        Copy{"Ffv1RgbDeep", "a.mkv", AV_PIX_FMT_GBRP12LE, 64, 48, VideoCodec::ffv1, "b.mkv"},
        Copy{"Ffv1Grey", "a.mkv", AV_PIX_FMT_GRAY8, 64, 48, VideoCodec::ffv1, "b.mkv"}),
    [](const testing::TestParamInfo<Copy>& test) { return test.param.name; });

TEST_F(VideoSinkTest, FullRangeFootageStaysFullRange) {
    TestClip clip;
    clip.range = AVCOL_RANGE_JPEG;
    clip.matrix = AVCOL_SPC_SMPTE170M;
    write_clip(clip, folder_ / "a.mp4");  // decodes to yuvj420p
    for (const char* name : {"b.mp4", "b.mkv"}) {
        transcode(folder_ / "a.mp4", folder_ / name, lossless(VideoCodec::h264));
        expect_equal(folder_ / "a.mp4", folder_ / name);
    }
    transcode(folder_ / "a.mp4", folder_ / "c.mkv", lossless(VideoCodec::ffv1));
    expect_equal(folder_ / "a.mp4", folder_ / "c.mkv");
}

TEST_F(VideoSinkTest, LayoutsThatNoEncoderHasAreReorderedWithoutLoss) {
    for (const AVPixelFormat format : {AV_PIX_FMT_NV12, AV_PIX_FMT_P010LE, AV_PIX_FMT_YUYV422, AV_PIX_FMT_RGB24,
                                       AV_PIX_FMT_RGBA, AV_PIX_FMT_YUV420P10BE}) {
        TestClip clip;
        clip.pixel_format = format;
        FootageInfo info;
        info.format = plate_format_of(*test_samples(clip, 0), 0, {}, "test");
        info.frame_count = 3;
        VideoOptions options = lossless(VideoCodec::ffv1);
        VideoSink sink(folder_ / "b.mkv", info, options, warnings_);
        for (int i = 0; i < 3; ++i) sink.write({test_samples(clip, i), info.format, i, i / 25.0});
        sink.finish();
        const auto source = FrameSource::open(folder_ / "b.mkv", {}, warnings_);
        for (int i = 0; i < 3; ++i)
            EXPECT_TRUE(same_samples(*source->next()->samples(), *test_samples(clip, i))) << info.format.pixel_format;
    }
    EXPECT_TRUE(warnings_.empty()) << warnings_.entries().front().text;
}

TEST_F(VideoSinkTest, TouchedPixelsChangeAndNoOthers) {
    write_clip({}, folder_ / "a.mp4");
    const auto source = FrameSource::open(folder_ / "a.mp4", {}, warnings_);
    VideoSink sink(folder_ / "b.mp4", source->info(), lossless(VideoCodec::h264), warnings_);
    const Region region{10, 8, 20, 16};
    while (auto frame = source->next()) {
        frame->write_rgb_code(region, ImageF(20, 16, 3, 1.0f), Image8(20, 16, 1, 1));
        sink.write(*frame);
    }
    sink.finish();
    const auto before = FrameSource::open(folder_ / "a.mp4", {}, warnings_);
    const auto after = FrameSource::open(folder_ / "b.mp4", {}, warnings_);
    while (const auto frame = before->next()) {
        const AVFrame& a = *frame->samples();
        const auto other = after->next();
        ASSERT_TRUE(other);
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                const int luma = other->samples()->data[0][y * other->samples()->linesize[0] + x];
                ASSERT_EQ(luma, region.contains(x, y) ? 235 : a.data[0][y * a.linesize[0] + x]);
                if (region.contains(x, y)) continue;
                ASSERT_EQ(other->samples()->data[1][y / 2 * other->samples()->linesize[1] + x / 2],
                          a.data[1][y / 2 * a.linesize[1] + x / 2]);
            }
        }
    }
}

TEST_F(VideoSinkTest, TheSameFramesGiveTheSameFile) {
    VideoOptions options;
    options.comment = "scene";
    options.preset = "fast";
    for (const auto& [codec, name] : {std::pair{VideoCodec::h264, "h264.mp4"},
                                      {VideoCodec::h264, "h264.mkv"},
                                      {VideoCodec::h265, "h265.mp4"},
                                      {VideoCodec::ffv1, "ffv1.mkv"},
                                      {VideoCodec::prores4444, "prores.mov"}}) {
        for (const int width : {64, 128, 200}) {  // 4, 8 and 12.5 macroblocks
            TestClip clip;
            clip.width = width;
            write_clip(clip, folder_ / "a.mp4");
            options.codec = codec;
            std::string first;
            for (const int leftover : {0, 1, 170}) {
                mallopt(M_PERTURB, leftover);  // what the memory holds that is given out must not matter
                transcode(folder_ / "a.mp4", folder_ / name, options);
                mallopt(M_PERTURB, 0);
                const std::string bytes = bytes_of(folder_ / name);
                EXPECT_TRUE(first.empty() || bytes == first) << name << ' ' << width;
                first = bytes;
            }
            EXPECT_THAT(first, HasSubstr("scene"));
        }
    }
}

// ---- sound -------------------------------------------------------------------------------------------------------

std::vector<std::string> payloads(const std::vector<PacketBytes>& packets, int stream) {
    std::vector<std::string> bytes;
    for (const PacketBytes& packet : packets) {
        if (packet.stream == stream) bytes.push_back(packet.bytes);
    }
    return bytes;
}

TEST_F(VideoSinkTest, SoundIsCopiedUntouched) {
    for (const auto& [encoder, from, to] :
         {std::tuple{"aac", "a.mp4", "b.mp4"}, {"aac", "a.mp4", "b.mkv"}, {"pcm_s16le", "a.mov", "b.mov"}}) {
        TestClip clip;
        clip.audio_encoder = encoder;
        clip.audio_streams = 2;
        clip.frames = 30;
        write_clip(clip, folder_ / from);
        VideoOptions options;
        options.preset = "ultrafast";
        transcode(folder_ / from, folder_ / to, options);
        const auto before = packets_of(folder_ / from, AVMEDIA_TYPE_AUDIO);
        const auto after = packets_of(folder_ / to, AVMEDIA_TYPE_AUDIO);
        ASSERT_FALSE(before.empty());
        for (const int stream : {1, 2}) {
            const auto sum = [&](const auto& packets) {
                const auto parts = payloads(packets, stream);
                return std::accumulate(parts.begin(), parts.end(), std::string());
            };
            EXPECT_EQ(sum(before), sum(after)) << to;
            EXPECT_FALSE(sum(after).empty());
        }
        // Matroska has no negative times, so it shifts picture and sound together.
        const auto lead_s = [&](const char* name, const std::vector<PacketBytes>& sound) {
            return packets_of(folder_ / name, AVMEDIA_TYPE_VIDEO).front().time_s - sound.front().time_s;
        };
        EXPECT_NEAR(lead_s(from, before), lead_s(to, after), 0.0011) << to;
        EXPECT_TRUE(FrameSource::open(folder_ / to, {}, warnings_)->info().has_audio);
    }
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(VideoSinkTest, ARenderedSpanHasItsOwnSound) {
    TestClip clip;
    clip.audio_encoder = "pcm_s16le";  // every packet can be told by its samples
    clip.frames = 50;
    write_clip(clip, folder_ / "a.mov");
    VideoOptions options;
    options.preset = "ultrafast";
    transcode(folder_ / "a.mov", folder_ / "b.mov", options, {20, 34});
    const auto source = FrameSource::open(folder_ / "b.mov", {}, warnings_);
    EXPECT_EQ(source->info().frame_count, 15);
    const auto sum = [](const std::vector<PacketBytes>& packets) {
        std::string bytes;
        for (const PacketBytes& packet : packets) bytes += packet.bytes;
        return bytes;
    };
    const std::string all = sum(packets_of(folder_ / "a.mov", AVMEDIA_TYPE_AUDIO));
    const std::string part = sum(packets_of(folder_ / "b.mov", AVMEDIA_TYPE_AUDIO));
    // 48 kHz of 2 bytes; packets at either end reach over the span by less than one packet of 1024 samples.
    constexpr double bytes_a_second = 96000;
    const std::size_t at = all.find(part);
    ASSERT_NE(at, std::string::npos);
    EXPECT_NEAR(static_cast<double>(at), 0.8 * bytes_a_second, 2048);
    EXPECT_NEAR(static_cast<double>(part.size()), 0.6 * bytes_a_second, 4096);
}

TEST_F(VideoSinkTest, SoundThatTheContainerCannotHoldIsLeftOutWithAWarning) {
    TestClip clip;
    clip.audio_encoder = "pcm_s16le";
    write_clip(clip, folder_ / "a.mov");
    transcode(folder_ / "a.mov", folder_ / "b.mp4", {});
    EXPECT_EQ(warned("pcm_s16le sound"), 1);
    EXPECT_FALSE(FrameSource::open(folder_ / "b.mp4", {}, warnings_)->info().has_audio);
    VideoOptions mute;
    mute.copy_audio = false;
    transcode(folder_ / "a.mov", folder_ / "c.mov", mute);
    EXPECT_FALSE(FrameSource::open(folder_ / "c.mov", {}, warnings_)->info().has_audio);
}

// ---- conversions -------------------------------------------------------------------------------------------------

class SequenceToVideo : public VideoSinkTest {
protected:
    /// Smooth pictures, so that subsampled chroma can hold them.
    void write_pictures(int width, int height) {
        for (int i = 0; i < 3; ++i) {
            Image8 image(width, height, 3);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    image.at(x, y, 0) = static_cast<std::uint8_t>(60 + 2 * x);
                    image.at(x, y, 1) = static_cast<std::uint8_t>(200 - 2 * y);
                    image.at(x, y, 2) = static_cast<std::uint8_t>(100 + 10 * i);
                }
            }
            write_png8(folder_ / ("f_00" + std::to_string(i) + ".png"), image);
        }
    }
    int largest_error(const fs::path& video) {
        const auto source = FrameSource::open(video, {}, warnings_);
        int largest = 0, count = 0;
        while (const auto frame = source->next()) {
            const Image8 expected = read_rgb8(folder_ / ("f_00" + std::to_string(count++) + ".png"));
            const Image8 actual = frame->rgb8(expected.bounds());
            for (std::size_t i = 0; i < expected.samples().size(); ++i)
                largest = std::max(largest, std::abs(expected.samples()[i] - actual.samples()[i]));
        }
        EXPECT_EQ(count, 3);
        return largest;
    }
};

TEST_F(SequenceToVideo, BecomesBt709InDeliveryCodecs) {
    write_pictures(64, 48);
    for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
        transcode(folder_ / "f_%03d.png", folder_ / "b.mp4", lossless(codec));
        const auto source = FrameSource::open(folder_ / "b.mp4", {}, warnings_);
        EXPECT_EQ(source->info().format.pixel_format, "yuv420p");
        EXPECT_EQ(source->info().format.matrix, ColorMatrix::bt709);
        EXPECT_EQ(source->info().format.range, ColorRange::limited);
        EXPECT_FALSE(source->info().format.matrix_guessed);
        // Rounding of three samples; at the picture's edge interpolation cannot follow the ramp: one step of it more.
        EXPECT_LE(largest_error(folder_ / "b.mp4"), 4);
    }
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SequenceToVideo, OddSizesKeepFullChroma) {
    write_pictures(65, 47);
    transcode(folder_ / "f_%03d.png", folder_ / "b.mp4", lossless(VideoCodec::h264));
    EXPECT_EQ(FrameSource::open(folder_ / "b.mp4", {}, warnings_)->info().format.width, 65);
    EXPECT_LE(largest_error(folder_ / "b.mp4"), 2);
    EXPECT_EQ(warned("yuv444p"), 1);
}

TEST_F(SequenceToVideo, StaysRgbInFfv1) {
    write_pictures(65, 47);
    transcode(folder_ / "f_%03d.png", folder_ / "b.mkv", lossless(VideoCodec::ffv1));
    EXPECT_EQ(largest_error(folder_ / "b.mkv"), 0);
}

TEST_F(SequenceToVideo, DeepPicturesStayWholeInFfv1) {
    Image16 image(20, 10, 3);
    for (std::size_t i = 0; i < image.samples().size(); ++i) image.samples()[i] = static_cast<std::uint16_t>(107 * i);
    write_png16(folder_ / "d_0.png", image);
    transcode(folder_ / "d_%d.png", folder_ / "b.mkv", lossless(VideoCodec::ffv1));
    const auto frame = FrameSource::open(folder_ / "b.mkv", {}, warnings_)->next();
    EXPECT_TRUE(std::ranges::equal(frame->rgb16(image.bounds()).samples(), image.samples()));
}

TEST_F(VideoSinkTest, ARequestedPixelFormatIsConvertedTo) {
    write_clip({}, folder_ / "a.mp4");
    VideoOptions options = lossless(VideoCodec::h264);
    options.pixel_format = "yuv444p10le";
    transcode(folder_ / "a.mp4", folder_ / "b.mp4", options);
    const auto before = FrameSource::open(folder_ / "a.mp4", {}, warnings_)->next();
    const auto after = FrameSource::open(folder_ / "b.mp4", {}, warnings_)->next();
    EXPECT_EQ(after->format().pixel_format, "yuv444p10le");
    const Region all{0, 0, 64, 48};
    const ImageF a = before->rgb_code(all), b = after->rgb_code(all);
    for (std::size_t i = 0; i < a.samples().size();
         ++i)  // half a step of luma and 1.86 half steps of chroma at 10 bits
        ASSERT_NEAR(a.samples()[i], b.samples()[i], 0.5 / 876 + 1.86 * 0.5 / 896);
    for (int x = 0; x < 64; ++x)  // luma only gains two bits
        EXPECT_EQ(reinterpret_cast<const std::uint16_t*>(after->samples()->data[0])[x],
                  before->samples()->data[0][x] * 4);
}

TEST_F(VideoSinkTest, ProresKeepsTheVirtualLayersAlpha) {
    write_clip({}, folder_ / "a.mp4");
    const auto source = FrameSource::open(folder_ / "a.mp4", {}, warnings_);
    VideoOptions options;
    options.codec = VideoCodec::prores4444;
    VideoSink sink(folder_ / "layer.mov", source->info(), options, warnings_);
    ImageF layer(64, 48, 4, 0.0f);
    for (int y = 10; y < 40; ++y) {
        for (int x = 16; x < 48; ++x) {
            const float rgba[] = {0.5f, 0.25f, 0.125f, 0.5f};
            std::ranges::copy(rgba, layer.pixel(x, y));
        }
    }
    for (int i = 0; i < 5; ++i) sink.write_rgba(layer, i, i / 25.0);
    sink.finish();
    const auto read = FrameSource::open(folder_ / "layer.mov", {}, warnings_);
    EXPECT_TRUE(read->info().format.has_alpha);
    EXPECT_EQ(read->info().frame_count, 5);
    const auto frame = read->next();
    const SampleLayout layout = *SampleLayout::of(static_cast<AVPixelFormat>(frame->samples()->format));
    std::uint16_t inside = 0, outside = 1;
    read_samples(layout, *frame->samples(), {3, 30, 25, 1}, &inside);
    read_samples(layout, *frame->samples(), {3, 2, 2, 1}, &outside);
    const double full = layout.component[3].max();
    EXPECT_NEAR(inside / full, 0.5, 0.002);  // alpha is coded without loss
    EXPECT_EQ(outside, 0);
    const ImageF code = frame->rgb_code({30, 25, 1, 1});
    EXPECT_NEAR(code.at(0, 0, 0), 0.5, 0.02);  // colour is not
    EXPECT_NEAR(code.at(0, 0, 2), 0.125, 0.02);
}

// ---- faults ------------------------------------------------------------------------------------------------------

TEST_F(VideoSinkTest, ImpossibleOutputsAreRefusedBeforeTheFirstFrame) {
    write_clip({}, folder_ / "a.mp4");
    TestClip turned;
    turned.rotation_deg = 90;
    write_clip(turned, folder_ / "turned.mp4");
    const auto refusal = [&](const char* footage, const char* output, VideoCodec codec,
                             std::optional<std::string> pixel_format) {
        const auto source = FrameSource::open(folder_ / footage, {}, warnings_);
        VideoOptions options;
        options.codec = codec;
        options.pixel_format = std::move(pixel_format);
        return error_of([&] { VideoSink(folder_ / output, source->info(), options, warnings_); });
    };
    EXPECT_THAT(refusal("a.mp4", "b.avi", VideoCodec::h264, {}), AllOf(HasSubstr(".avi"), HasSubstr("use .mp4")));
    EXPECT_THAT(refusal("a.mp4", "b.mp4", VideoCodec::ffv1, {}), AllOf(HasSubstr("ffv1"), HasSubstr("use .mkv")));
    EXPECT_THAT(refusal("a.mp4", "b.mp4", VideoCodec::prores4444, {}), HasSubstr("use .mov"));
    EXPECT_THAT(refusal("a.mp4", "b.mp4", VideoCodec::h264, "nonsense"), HasSubstr("nonsense"));
    EXPECT_THAT(refusal("a.mp4", "b.mp4", VideoCodec::h264, "gbrpf32le"), HasSubstr("it has yuv420p"));
    EXPECT_THAT(refusal("a.mp4", "none/b.mp4", VideoCodec::h264, {}), HasSubstr("b.mp4"));
    EXPECT_THAT(refusal("turned.mp4", "b.mkv", VideoCodec::h264, {}), HasSubstr("rotation"));
    EXPECT_FALSE(fs::exists(folder_ / "b.mp4"));
    EXPECT_FALSE(fs::exists(folder_ / "b.part.mp4"));
}

TEST_F(VideoSinkTest, AFullDiskIsAnErrorAtItsFrameAndLeavesNothing) {
    TestClip clip;
    clip.width = 320;
    clip.height = 240;
    clip.frames = 40;
    write_clip(clip, folder_ / "a.mp4");
    const std::pair<VideoCodec, const char*> outputs[] = {
        {VideoCodec::h264, "b.mp4"}, {VideoCodec::ffv1, "b.mkv"}, {VideoCodec::prores4444, "b.mov"}};
    for (const auto& output : outputs) {
        const FileSizeLimit limit(300000);
        EXPECT_THAT(error_of([&] { transcode(folder_ / "a.mp4", folder_ / output.second, lossless(output.first)); }),
                    AllOf(HasSubstr(output.second), HasSubstr("frame "), HasSubstr("free some space")));
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);  // the footage alone
}

TEST_F(VideoSinkTest, WhatIsNotFinishedIsNotThere) {
    write_clip({}, folder_ / "a.mp4");
    {
        const auto source = FrameSource::open(folder_ / "a.mp4", {}, warnings_);
        VideoSink sink(folder_ / "b.mp4", source->info(), {}, warnings_);
        sink.write(*source->next());
        EXPECT_FALSE(fs::exists(folder_ / "b.mp4"));
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
    const auto source = FrameSource::open(folder_ / "a.mp4", {}, warnings_);
    VideoSink sink(folder_ / "b.mp4", source->info(), {}, warnings_);
    EXPECT_THAT(error_of([&] { sink.finish(); }), HasSubstr("no frame"));
}

TEST(VideoEncoders, AllFourAreHere) {
    EXPECT_THAT(available_video_encoders(), testing::ElementsAre("h264", "h265", "ffv1", "prores4444"));
    EXPECT_EQ(video_codec_from_name("h265"), VideoCodec::h265);
    EXPECT_FALSE(video_codec_from_name("vp9"));
}

}  // namespace
}  // namespace matchlight
