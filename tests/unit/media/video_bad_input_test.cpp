// Every row of damaged, hostile and odd video files: an error that names the file, or a counted warning.
#include <cstring>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "media/frame_source.h"
#include "scratch_folder.h"
#include "test_clip.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class VideoBadInput : public ScratchFolder {
protected:
    std::string open_error(const fs::path& path, const FootageOptions& options = {}) {
        return error_of([&] { FrameSource::open(path, options, warnings_); });
    }
    /// Frames that come out, reading to the end; `message` receives an error if one ends it.
    int count_frames(const fs::path& path, const FootageOptions& options = {}, std::string* message = nullptr) {
        int count = 0;
        const std::string error = error_of([&] {
            const auto source = FrameSource::open(path, options, warnings_);
            while (source->next()) ++count;
        });
        if (message != nullptr) {
            *message = error;
        } else {
            EXPECT_EQ(error, "");
        }
        return count;
    }
    fs::path clip(const TestClip& spec, const std::string& name) {
        write_clip(spec, folder_ / name);
        return folder_ / name;
    }
    static FootageOptions strict() {
        FootageOptions options;
        options.strict = true;
        return options;
    }
};

TEST_F(VideoBadInput, NothingThatIsAVideo) {
    EXPECT_THAT(open_error(folder_ / "none.mp4"), HasSubstr("no such file"));
    EXPECT_THAT(open_error(write_bytes("zero.mp4", "")), AllOf(HasSubstr("zero.mp4"), HasSubstr("zero bytes")));
    EXPECT_THAT(open_error(folder_), HasSubstr("folder"));
    EXPECT_THAT(open_error("/dev/zero"), HasSubstr("not a regular file"));
    EXPECT_THAT(open_error("http://localhost/clip.mp4"), HasSubstr("no such file"));
    ASSERT_EQ(mkfifo((folder_ / "pipe.mp4").c_str(), 0600), 0);
    EXPECT_THAT(open_error(folder_ / "pipe.mp4"), HasSubstr("not a regular file"));
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::string noise(20000, '\0');
        unsigned state = seed;
        for (char& c : noise) c = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
        EXPECT_THAT(open_error(write_bytes("noise.mp4", noise)), HasSubstr("noise.mp4")) << seed;
    }
}

TEST_F(VideoBadInput, FilesThatNameOtherFiles) {
    const fs::path good = clip({}, "good.mp4");
    const std::string name = good.string();
    const std::pair<const char*, std::string> lists[] = {
        {"concat.mp4", "ffconcat version 1.0\nfile '" + name + "'\n"},
        {"hls.mp4",
         "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXT-X-VERSION:3\n#EXTINF:1,\nfile://" + name + "\n#EXT-X-ENDLIST\n"},
        {"hls.m3u8", "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n" + name + "\n#EXT-X-ENDLIST\n"},
        {"dash.mpd",
         "<?xml version=\"1.0\"?><MPD type=\"static\"><Period><AdaptationSet><Representation "
         "id=\"0\"><BaseURL>" +
             name + "</BaseURL></Representation></AdaptationSet></Period></MPD>"},
        {"sdp.mp4", "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 RTP/AVP 96\n"},
    };
    for (const auto& [file, text] : lists) EXPECT_THAT(open_error(write_bytes(file, text)), HasSubstr(file)) << file;
}

TEST_F(VideoBadInput, AudioOnly) {
    TestClip spec;
    spec.video = false;
    spec.audio_encoder = "aac";
    EXPECT_THAT(open_error(clip(spec, "sound.mp4")), HasSubstr("holds no video"));
    EXPECT_THAT(open_error(clip(spec, "sound.mkv")), HasSubstr("holds no video"));
}

TEST_F(VideoBadInput, NoMoov) {
    TestClip spec;
    spec.header_first = false;
    const std::string bytes = bytes_of(clip(spec, "whole.mp4"));
    const std::size_t moov = bytes.find("moov");
    ASSERT_NE(moov, std::string::npos);
    EXPECT_THAT(open_error(write_bytes("headless.mp4", bytes.substr(0, moov - 4))), HasSubstr("headless.mp4"));
}

TEST_F(VideoBadInput, NoFrames) {
    TestClip spec;
    spec.frames = 0;
    EXPECT_THAT(open_error(clip(spec, "empty.mp4")), HasSubstr("empty.mp4"));
    EXPECT_THAT(open_error(clip(spec, "empty.mkv")), HasSubstr("empty.mkv"));
}

TEST_F(VideoBadInput, TruncatedClipSaysHowMuchIsThere) {
    for (const char* extension : {"mp4", "mov", "mkv", "avi"}) {
        TestClip spec;
        spec.frames = 50;
        spec.b_frames = 0;
        const std::string bytes = bytes_of(clip(spec, std::string("whole.") + extension));
        const fs::path cut = write_bytes(std::string("cut.") + extension, bytes.substr(0, bytes.size() * 6 / 10));
        Warnings fresh;
        fresh.set_quiet(true);
        int count = 0;
        const auto source = FrameSource::open(cut, {}, fresh);
        while (source->next()) ++count;
        EXPECT_GT(count, 20) << extension;
        EXPECT_LT(count, 40) << extension;
        EXPECT_EQ(source->info().frame_count, count) << extension;
        ASSERT_FALSE(fresh.empty()) << extension;
        EXPECT_THAT(fresh.entries().front().text,
                    HasSubstr("cut." + std::string(extension) + ": " + std::to_string(count) + " of 50 frames"));
        EXPECT_THAT(open_error(cut, strict()), HasSubstr("of 50 frames")) << extension;
    }
}

TEST_F(VideoBadInput, CorruptMacroblocksAreCountedAndStrictlyRefused) {
    for (const std::string encoder : {"libx264", "mpeg2video", "ffv1", "libx265"}) {
        TestClip spec;
        spec.encoder = encoder;
        spec.options.clear();
        spec.frames = 12;
        spec.width = 320;
        spec.height = 240;
        spec.b_frames = 0;
        // CAVLC finds wrong codes where CABAC may read on.
        if (encoder == "libx264") spec.options = {{"x264-params", "cabac=0:log-level=none"}};
        if (encoder == "libx265") spec.options = {{"x265-params", "log-level=none"}};
        if (encoder == "ffv1") spec.options = {{"level", "3"}, {"slicecrc", "1"}};
        int packet = 0;
        spec.on_packet = [&packet](AVPacket& data) {
            if (++packet != 6) return;  // one packet in the middle, from its middle on
            for (int i = data.size / 2; i < data.size * 3 / 4; ++i) data.data[i] = static_cast<std::uint8_t>(i * 37);
        };
        const fs::path damaged = clip(spec, encoder + ".mkv");
        const std::int64_t before = warnings_.total();
        EXPECT_GE(count_frames(damaged), 11) << encoder;  // FFV1 gives a frame whose checksum fails up
        EXPECT_GT(warnings_.total(), before) << encoder;
        std::string message;
        count_frames(damaged, strict(), &message);
        EXPECT_THAT(message, AllOf(HasSubstr(encoder), HasSubstr("damaged"))) << encoder;
    }
}

TEST_F(VideoBadInput, AFrameThatCannotBeDecodedLeavesAGap) {
    TestClip spec;
    spec.encoder = "mjpeg";
    spec.options.clear();
    spec.pixel_format = AV_PIX_FMT_YUVJ420P;
    spec.b_frames = 0;
    spec.range = AVCOL_RANGE_JPEG;
    int packet = 0;
    spec.on_packet = [&packet](AVPacket& data) {
        if (++packet == 4) std::memset(data.data, 0, static_cast<std::size_t>(data.size));
    };
    const auto source = FrameSource::open(clip(spec, "gap.mkv"), {}, warnings_);
    std::vector<std::int64_t> indices;
    while (const auto frame = source->next()) {
        indices.push_back(frame->index());
        EXPECT_NEAR(frame->time_s(), static_cast<double>(frame->index()) / 25, 0.00051);
    }
    EXPECT_THAT(indices, testing::ElementsAre(0, 1, 2, 4, 5, 6, 7, 8, 9));
    EXPECT_EQ(warned("9 of 10 frames could be decoded"), 1);
}

TEST_F(VideoBadInput, SizeChangesInMidStream) {
    TestClip spec;
    spec.encoder = "mjpeg";
    spec.options.clear();
    spec.pixel_format = AV_PIX_FMT_YUVJ420P;
    spec.b_frames = 0;
    spec.range = AVCOL_RANGE_JPEG;
    spec.size_changes_at = 5;
    std::string message;
    EXPECT_EQ(count_frames(clip(spec, "change.mkv"), {}, &message), 5);
    EXPECT_THAT(message, AllOf(HasSubstr("change.mkv"), HasSubstr("frame 5"), HasSubstr("64x48"), HasSubstr("128x48")));
}

TEST_F(VideoBadInput, AbsurdSizeInTheHeader) {
    TestClip spec;
    spec.declared_width = 65536;
    EXPECT_THAT(open_error(clip(spec, "wide.mkv")), AllOf(HasSubstr("wide.mkv"), HasSubstr("65536")));
}

TEST_F(VideoBadInput, WrongDeclaredCount) {
    TestClip spec;
    spec.encoder = "mjpeg";
    spec.options.clear();
    spec.pixel_format = AV_PIX_FMT_YUVJ420P;
    spec.b_frames = 0;
    const std::string bytes = bytes_of(clip(spec, "whole.avi"));
    const std::size_t header = bytes.find("strh");
    ASSERT_NE(header, std::string::npos);
    for (const auto& [claimed, text] : {std::pair{99, "10 of 99 frames"}, {7, "declares 7 frames, it holds 10"}}) {
        std::string changed = bytes;
        changed[header + 8 + 32] = static_cast<char>(claimed);  // dwLength of AVISTREAMHEADER
        EXPECT_EQ(count_frames(write_bytes("wrong.avi", changed)), 10);
        EXPECT_EQ(warned(text), 1) << text;
    }
}

TEST_F(VideoBadInput, InterlacedIsCounted) {
    TestClip spec;
    spec.encoder = "mpeg2video";
    spec.options.clear();
    spec.interlaced = true;
    spec.frames = 6;
    EXPECT_EQ(count_frames(clip(spec, "interlaced.ts")), 6);
    EXPECT_EQ(warned("interlaced"), 6);
    EXPECT_EQ(warned("could be decoded"), 0);
}

TEST_F(VideoBadInput, TimeStampsThatRunBackwards) {
    TestClip spec;
    spec.encoder = "mjpeg";
    spec.options.clear();
    spec.pixel_format = AV_PIX_FMT_YUVJ420P;
    spec.b_frames = 0;
    spec.frames = 6;
    int packet = 0;
    spec.on_packet = [&packet](AVPacket& data) {
        constexpr int shown_at[] = {0, 1, 4, 2, 5, 6};
        data.dts = packet - 10;  // the container wants these to grow
        data.pts = shown_at[packet++];
    };
    const auto source = FrameSource::open(clip(spec, "backwards.mkv"), {}, warnings_);
    double last_s = -1;
    int index = 0;
    while (const auto frame = source->next()) {
        EXPECT_GT(frame->time_s(), last_s);  // an output needs times that grow
        EXPECT_EQ(frame->index(), index++);
        last_s = frame->time_s();
    }
    EXPECT_EQ(index, 6);
    EXPECT_EQ(warned("run backwards"), 1);
    source->seek(3);
    EXPECT_EQ(source->next()->index(), 3);
}

TEST_F(VideoBadInput, RangesAndMatricesAreRead) {
    for (const AVColorRange range : {AVCOL_RANGE_MPEG, AVCOL_RANGE_JPEG}) {
        for (const AVColorSpace matrix : {AVCOL_SPC_SMPTE170M, AVCOL_SPC_BT709}) {
            TestClip spec;
            spec.range = range;
            spec.matrix = matrix;
            const auto source = FrameSource::open(clip(spec, "tagged.mp4"), {}, warnings_);
            EXPECT_EQ(source->info().format.range, range == AVCOL_RANGE_JPEG ? ColorRange::full : ColorRange::limited);
            EXPECT_EQ(source->info().format.matrix,
                      matrix == AVCOL_SPC_BT709 ? ColorMatrix::bt709 : ColorMatrix::bt601);
        }
    }
    TestClip spec;
    spec.matrix = AVCOL_SPC_YCGCO;
    EXPECT_THAT(open_error(clip(spec, "ycgco.mp4")), HasSubstr("ycgco"));
}

}  // namespace
}  // namespace matchlight
