// Decoding: samples, tags, time stamps and seeking of good footage.
#include <cmath>

#include <gmock/gmock.h>

#include "media/frame_source.h"
#include "media/image_io.h"
#include "scratch_folder.h"
#include "test_clip.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class VideoSourceTest : public ScratchFolder {
protected:
    std::unique_ptr<FrameSource> open(const TestClip& clip, const std::string& name,
                                      const FootageOptions& options = {}) {
        write_clip(clip, folder_ / name);
        return FrameSource::open(folder_ / name, options, warnings_);
    }
    /// Reads to the end and checks every frame against the samples that were encoded.
    void expect_whole(FrameSource& source, const TestClip& clip) {
        int count = 0;
        while (const auto frame = source.next()) {
            EXPECT_EQ(frame->index(), count);
            EXPECT_TRUE(same_samples(*frame->samples(), *test_samples(clip, count))) << "frame " << count;
            const auto ticks = clip.pts.empty() ? count : clip.pts[static_cast<std::size_t>(count)] - clip.pts[0];
            // Matroska keeps milliseconds.
            EXPECT_NEAR(frame->time_s(), static_cast<double>(ticks) * av_q2d(clip.time_base), 0.00051);
            ++count;
        }
        EXPECT_EQ(count, clip.frames);
        EXPECT_TRUE(warnings_.empty()) << warnings_.entries().front().text;
    }
};

struct Lossless {
    const char* name;
    const char* file;
    const char* encoder;
    AVPixelFormat format;
    int width, height;
};

class LosslessClip : public VideoSourceTest, public testing::WithParamInterface<Lossless> {};

TEST_P(LosslessClip, ComesBackSampleBySample) {
    TestClip clip;
    clip.encoder = GetParam().encoder;
    if (clip.encoder == "ffv1") clip.options.clear();
    clip.pixel_format = GetParam().format;
    clip.width = GetParam().width;
    clip.height = GetParam().height;
    const auto source = open(clip, GetParam().file);
    EXPECT_EQ(source->info().frame_count, clip.frames);
    EXPECT_NEAR(source->info().fps, 25, 1e-3);
    EXPECT_FALSE(source->info().variable_frame_rate);
    EXPECT_EQ(source->info().format.width, clip.width);
    expect_whole(*source, clip);
}

INSTANTIATE_TEST_SUITE_P(Formats, LosslessClip,
                         testing::Values(Lossless{"H264", "a.mp4", "libx264", AV_PIX_FMT_YUV420P, 64, 48},
                                         Lossless{"H264InMatroska", "a b.mkv", "libx264", AV_PIX_FMT_YUV420P, 64, 48},
                                         Lossless{"H264InTransportStream", "a.ts", "libx264", AV_PIX_FMT_YUV420P, 64,
                                                  48},
                                         Lossless{"H264TenBit", "a.mov", "libx264", AV_PIX_FMT_YUV420P10LE, 64, 48},
                                         Lossless{"H264FullChroma", "a.mp4", "libx264", AV_PIX_FMT_YUV444P, 63, 47},
                                         Lossless{"Odd", "a.mkv", "ffv1", AV_PIX_FMT_YUV420P, 641, 361},
                                         Lossless{"Alpha", "a.mkv", "ffv1", AV_PIX_FMT_YUVA444P, 64, 48},
                                         Lossless{"Rgb", "a.mkv", "ffv1", AV_PIX_FMT_BGR0, 64, 48},
                                         Lossless{"RgbTenBit", "a.mkv", "ffv1", AV_PIX_FMT_GBRP10LE, 64, 48},
                                         Lossless{"SixteenBit", "a.mkv", "ffv1", AV_PIX_FMT_YUV422P16LE, 64, 48},
                                         Lossless{"Grey", "a.avi", "ffv1", AV_PIX_FMT_GRAY8, 64, 48}),
                         [](const testing::TestParamInfo<Lossless>& test) { return test.param.name; });

TEST_F(VideoSourceTest, OneFrame) {
    TestClip clip;
    clip.frames = 1;
    const auto source = open(clip, "one.mp4");
    EXPECT_EQ(source->info().frame_count, 1);
    expect_whole(*source, clip);
}

TEST_F(VideoSourceTest, VariableFrameRateKeepsItsTimes) {
    TestClip clip;
    clip.time_base = {1, 1000};
    clip.frames = 8;
    clip.pts = {0, 33, 67, 150, 183, 400, 417, 433};
    const auto source = open(clip, "vfr.mp4");
    EXPECT_TRUE(source->info().variable_frame_rate);
    EXPECT_NEAR(source->info().fps, 7 / 0.433, 0.01);
    expect_whole(*source, clip);
}

TEST_F(VideoSourceTest, TagsAreCarried) {
    TestClip clip;
    clip.matrix = AVCOL_SPC_BT2020_NCL;
    clip.range = AVCOL_RANGE_JPEG;
    clip.transfer = AVCOL_TRC_ARIB_STD_B67;
    clip.sample_aspect = {4, 3};
    clip.audio_encoder = "aac";
    const auto source = open(clip, "tags.mp4");
    const FootageInfo& info = source->info();
    EXPECT_EQ(info.format.matrix, ColorMatrix::bt2020);
    EXPECT_EQ(info.format.range, ColorRange::full);
    EXPECT_EQ(info.format.transfer, Transfer::hlg);
    EXPECT_EQ(info.format.siting, ChromaSiting::left);
    EXPECT_FALSE(info.format.matrix_guessed);
    EXPECT_EQ(info.sample_aspect.numerator, 4);
    EXPECT_EQ(info.sample_aspect.denominator, 3);
    EXPECT_TRUE(info.has_audio);
    EXPECT_EQ(info.codec, "h264");
    EXPECT_EQ(info.format.chroma_block_width, 2);
}

TEST_F(VideoSourceTest, OptionsOverrideTags) {
    FootageOptions options;
    options.matrix = ColorMatrix::bt601;
    options.range = ColorRange::full;
    const auto source = open({}, "a.mp4", options);
    EXPECT_EQ(source->info().format.matrix, ColorMatrix::bt601);
    EXPECT_EQ(source->next()->format().range, ColorRange::full);
}

TEST_F(VideoSourceTest, DisplayMatrixTurnsThePicture) {
    for (const int degrees : {90, 180, 270}) {
        TestClip clip;
        clip.rotation_deg = degrees;
        const auto source = open(clip, "turned.mp4");
        EXPECT_EQ(source->info().format.rotation_deg, degrees);
        EXPECT_EQ(source->info().format.width, degrees == 180 ? 64 : 48);
        const auto frame = source->next();
        const auto stored = test_samples(clip, 0);
        // Grey of the displayed top-left pixel is the luma of the stored corner that the turn brings there.
        const int sx = degrees == 90 ? 0 : 63, sy = degrees == 270 ? 0 : 47;
        const int luma = stored->data[0][sy * stored->linesize[0] + sx];
        EXPECT_NEAR(frame->gray_code({0, 0, 1, 1}).at(0, 0), (luma - 16) / 219.0, 1e-6) << degrees;
    }
}

TEST_F(VideoSourceTest, SeekingIsExact) {
    for (const char* name : {"seek.mp4", "seek.mkv", "seek.ts", "seek.avi"}) {
        TestClip clip;
        clip.frames = 70;
        clip.key_interval = 15;
        if (std::string(name).ends_with("avi")) clip.b_frames = 0;
        write_clip(clip, folder_ / name);
        const auto source = FrameSource::open(folder_ / name, {}, warnings_);
        for (const int target : {0, 40, 41, 3, 69, 14, 15, 16, 0, 68, 30, 52, 29}) {
            source->seek(target);
            for (int i = target; i < std::min(target + 3, 70); ++i) {
                const auto frame = source->next();
                ASSERT_TRUE(frame) << name << ' ' << i;
                EXPECT_EQ(frame->index(), i) << name;
                EXPECT_NEAR(frame->time_s(), i / 25.0, 0.00051) << name;
                EXPECT_TRUE(same_samples(*frame->samples(), *test_samples(clip, i))) << name << ' ' << i;
            }
        }
        source->seek(500);
        EXPECT_FALSE(source->next());
        source->seek(5);
        EXPECT_EQ(source->next()->index(), 5);
    }
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(VideoSourceTest, SeekingInVariableRateAndRotation) {
    TestClip clip;
    clip.time_base = {1, 1000};
    clip.rotation_deg = 90;
    clip.frames = 8;
    clip.pts = {0, 33, 67, 150, 183, 400, 417, 433};
    const auto source = open(clip, "vfr.mov");
    for (const int target : {6, 2, 7, 0}) {
        source->seek(target);
        const auto frame = source->next();
        EXPECT_EQ(frame->index(), target);
        EXPECT_NEAR(frame->time_s(), static_cast<double>(clip.pts[static_cast<std::size_t>(target)]) / 1000, 1e-9);
    }
}

TEST_F(VideoSourceTest, NameThatLooksLikeAProtocolIsOnlyAName) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    write_clip({}, folder_ / "plain.mp4");
    fs::rename("plain.mp4", "concat:a|b %03d.mp4");
    EXPECT_TRUE(FrameSource::open("concat:a|b %03d.mp4", {}, warnings_)->next());
    fs::current_path(before);
}

// ---- image sequences ---------------------------------------------------------------------------------------------

TEST_F(VideoSourceTest, ImageSequence) {
    for (int i = 0; i < 4; ++i)
        write_png8(folder_ / ("f_" + std::to_string(97 + i) + ".png"),
                   Image8(13, 7, 3, static_cast<std::uint8_t>(10 * i)));
    write_png8(folder_ / "f_0098.png", Image8(1, 1, 3));  // another pattern's
    FootageOptions options;
    options.sequence_fps = 30;
    const auto source = FrameSource::open(folder_ / "f_%d.png", options, warnings_);
    EXPECT_TRUE(source->info().is_sequence);
    EXPECT_EQ(source->info().first_number, 97);
    EXPECT_EQ(source->info().frame_count, 4);
    EXPECT_EQ(source->info().format.matrix, ColorMatrix::rgb);
    EXPECT_EQ(source->info().format.range, ColorRange::full);
    EXPECT_EQ(source->info().fps, 30);
    source->seek(2);
    for (int i = 2; i < 4; ++i) {
        const auto frame = source->next();
        EXPECT_EQ(frame->index(), i);
        EXPECT_NEAR(frame->time_s(), i / 30.0, 1e-12);
        EXPECT_EQ(frame->rgb8({12, 6, 1, 1}).at(0, 0, 1), 10 * i);
    }
    EXPECT_FALSE(source->next());
}

TEST_F(VideoSourceTest, DeepImageSequence) {
    Image16 image(3, 2, 3);
    for (std::size_t i = 0; i < image.samples().size(); ++i) image.samples()[i] = static_cast<std::uint16_t>(3001 * i);
    write_png16(folder_ / "f_0001.png", image);
    const auto source = FrameSource::open(folder_ / "f_%04d.png", {}, warnings_);
    EXPECT_EQ(source->info().format.bit_depth, 16);
    EXPECT_TRUE(std::ranges::equal(source->next()->rgb16({0, 0, 3, 2}).samples(), image.samples()));
}

TEST_F(VideoSourceTest, SequencesWithFaults) {
    const auto open_error = [&](const char* pattern) {
        return error_of([&] { FrameSource::open(folder_ / pattern, {}, warnings_); });
    };
    EXPECT_THAT(open_error("none_%d.png"), HasSubstr("no file matches"));
    for (const int i : {0, 1, 3}) write_png8(folder_ / ("gap_" + std::to_string(i) + ".png"), Image8(4, 4, 3));
    EXPECT_THAT(open_error("gap_%d.png"), testing::AllOf(HasSubstr("gap_2.png"), HasSubstr("frame 2")));
    write_png8(folder_ / "size_5.png", Image8(4, 4, 3));
    write_png8(folder_ / "size_6.png", Image8(4, 5, 3));
    const auto sized = FrameSource::open(folder_ / "size_%d.png", {}, warnings_);
    sized->next();
    EXPECT_THAT(error_of([&] { sized->next(); }), testing::AllOf(HasSubstr("frame 1"), HasSubstr("4x5")));
    write_png8(folder_ / "cut_0.png", Image8(4, 4, 3));
    write_bytes("cut_1.png", bytes_of(folder_ / "cut_0.png").substr(0, 40));
    const auto cut = FrameSource::open(folder_ / "cut_%d.png", {}, warnings_);
    cut->next();
    EXPECT_THAT(error_of([&] { cut->next(); }), HasSubstr("frame 1"));
}

// ---- the shared clip ---------------------------------------------------------------------------------------------

TEST_F(VideoSourceTest, SharedClipIsDecodedAsItsSourceWas) {
    const char* data = std::getenv("MATCHLIGHT_DATA");
    if (data == nullptr) GTEST_SKIP() << "MATCHLIGHT_DATA is not set";
    const auto source = FrameSource::open(fs::path(data) / "table/plate.mp4", {}, warnings_);
    int count = 0;
    while (const auto frame = source->next()) {
        const Image8 expected = read_rgb8(numbered(fs::path(data) / "table/plate_%03d.png", count++));
        const Image8 decoded = frame->rgb8(expected.bounds());
        double sum = 0;
        for (std::size_t i = 0; i < expected.samples().size(); ++i)
            sum += std::pow(expected.samples()[i] - decoded.samples()[i], 2);
        const double psnr_db = 10 * std::log10(255.0 * 255.0 / (sum / static_cast<double>(expected.samples().size())));
        // Measured 38.4 to 38.9: what H.264 left. BT.601's matrix gives 34.8, full range 29.5.
        EXPECT_GT(psnr_db, 38) << frame->index();
    }
    EXPECT_EQ(count, 12);
}

}  // namespace
}  // namespace matchlight
