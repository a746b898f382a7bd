// Bad, hostile and odd footage through the real executable: one line and status 1, or a counted warning and a result.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "../unit/media/test_clip.h"
#include "core/warnings.h"
#include "media/frame_sink.h"
#include "media/frame_source.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class MediaBadInput : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        fs::remove(shot_ / "plate.mp4");
        warnings_.set_quiet(true);
    }
    /// Makes `name` in the shot's folder its footage.
    void use_footage(const std::string& name) {
        std::string scene = bytes_of(sample_scene);
        const std::string before = "video = \"plate.mp4\"";
        scene.replace(scene.find(before), before.size(), "video = \"" + name + "\"");
        std::ofstream(shot_ / "table.toml", std::ios::binary | std::ios::trunc) << scene;
    }
    RunResult track(const std::string& name, bool strict = false) {
        use_footage(name);
        std::vector<std::string> arguments{"track", (shot_ / "table.toml").string(), "-o", solve().string()};
        if (strict) arguments.emplace_back("--strict");
        return run_matchlight(arguments);
    }
    fs::path solve() const { return shot_ / "out.solve.json"; }
    void expect_refused(const std::string& name, const std::vector<std::string>& words, bool strict = false) {
        EXPECT_TRUE(failed_naming(track(name, strict), words)) << name;
        EXPECT_TRUE(nothing_left_of(solve())) << name;
    }
    void expect_tracked(const std::string& name) {
        EXPECT_TRUE(succeeded(track(name))) << name;
        EXPECT_TRUE(fs::exists(solve())) << name;
        fs::remove(solve());
    }
    fs::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(shot_ / name, std::ios::binary) << bytes;
        return shot_ / name;
    }
    /// The sample's footage encoded anew.
    void transcode(const std::string& name, const VideoOptions& options) {
        const auto source = FrameSource::open(sample_footage, {}, warnings_);
        VideoSink sink(shot_ / name, source->info(), options, warnings_);
        while (const auto frame = source->next()) sink.write(*frame);
        sink.finish();
    }
    static VideoOptions fast(VideoCodec codec) {
        VideoOptions options;
        options.codec = codec;
        options.preset = "ultrafast";
        options.crf = 12;
        return options;
    }

    const fs::path sample_footage = fs::path(MATCHLIGHT_SOURCE_DIR) / "samples/table/plate.mp4";
    const fs::path sample_scene = fs::path(MATCHLIGHT_SOURCE_DIR) / "samples/table/table.toml";
    fs::path shot_;
    Warnings warnings_;
};

TEST_F(MediaBadInput, WhatIsNoVideo) {
    expect_refused("none.mp4", {"none.mp4", "no file"});
    write("zero.mp4", "");
    expect_refused("zero.mp4", {"zero.mp4", "zero bytes"});
    std::string noise(50000, '\0');
    unsigned state = 3;
    for (char& c : noise) c = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
    write("noise.mp4", noise);
    expect_refused("noise.mp4", {"noise.mp4"});
    ASSERT_EQ(mkfifo((shot_ / "pipe.mp4").c_str(), 0600), 0);
    expect_refused("pipe.mp4", {"pipe.mp4", "not a regular file"});
    fs::create_directory(shot_ / "folder.mp4");
    expect_refused("folder.mp4", {"folder.mp4", "folder"});
}

TEST_F(MediaBadInput, PlaylistsAndAddressesAreNotFollowed) {
    fs::copy_file(sample_footage, shot_ / "good.mp4");
    const std::string good = (shot_ / "good.mp4").string();
    write("list.mp4", "ffconcat version 1.0\nfile '" + good + "'\n");
    expect_refused("list.mp4", {"list.mp4"});
    write("hls.mp4", "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nfile://" + good + "\n#EXT-X-ENDLIST\n");
    expect_refused("hls.mp4", {"hls.mp4"});
    expect_refused("http://localhost/clip.mp4", {"clip.mp4", "no file"});
    expect_refused("concat:good.mp4|good.mp4", {"concat"});
}

TEST_F(MediaBadInput, FilesWithoutPictures) {
    TestClip sound;
    sound.video = false;
    sound.audio_encoder = "aac";
    write_clip(sound, shot_ / "sound.mp4");
    expect_refused("sound.mp4", {"sound.mp4", "holds no video"});
    TestClip empty;
    empty.frames = 0;
    write_clip(empty, shot_ / "empty.mp4");
    expect_refused("empty.mp4", {"empty.mp4"});
    // The sample keeps its index at the end.
    const std::string whole = bytes_of(sample_footage);
    write("headless.mp4", whole.substr(0, whole.rfind("moov") - 4));
    expect_refused("headless.mp4", {"headless.mp4"});
}

TEST_F(MediaBadInput, AbsurdSizeInTheHeader) {
    TestClip wide;
    wide.declared_width = 65536;
    write_clip(wide, shot_ / "wide.mkv");
    expect_refused("wide.mkv", {"wide.mkv", "65536"});
}

TEST_F(MediaBadInput, TruncatedFootageIsAWarningOrStrictlyAnError) {
    transcode("whole.mkv", fast(VideoCodec::ffv1));
    const std::string bytes = bytes_of(shot_ / "whole.mkv");
    write("cut.mkv", bytes.substr(0, bytes.size() * 6 / 10));
    const RunResult result = track("cut.mkv");
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"cut.mkv", "7 of 12 frames"}));
    fs::remove(solve());
    expect_refused("cut.mkv", {"cut.mkv", "of 12 frames"}, true);
}

TEST_F(MediaBadInput, DamagedFramesAreAWarningOrStrictlyAnErrorWithTheFrame) {
    transcode("whole.mkv", fast(VideoCodec::ffv1));
    std::string bytes = bytes_of(shot_ / "whole.mkv");
    for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 500; ++i) bytes[i] = static_cast<char>(i * 37);
    write("hit.mkv", bytes);
    const RunResult result = track("hit.mkv");
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"hit.mkv", "damaged frame"}));
    fs::remove(solve());
    expect_refused("hit.mkv", {"hit.mkv", "frame ", "damaged"}, true);
}

TEST_F(MediaBadInput, SizeChangesInMidStream) {
    TestClip change;
    change.encoder = "mjpeg";
    change.options.clear();
    change.pixel_format = AV_PIX_FMT_YUVJ420P;
    change.b_frames = 0;
    change.width = 640;
    change.height = 360;
    change.size_changes_at = 3;
    write_clip(change, shot_ / "change.mkv");
    expect_refused("change.mkv", {"change.mkv", "frame 3", "640x360", "1280x360"});
}

TEST_F(MediaBadInput, SequencesWithFaults) {
    const auto source = FrameSource::open(sample_footage, {}, warnings_);
    for (int i = 0; i < 4; ++i) {
        const Image8 picture = source->next()->rgb8({0, 0, 640, 360});
        write_png8(shot_ / numbered("good_%03d.png", 5 + i), picture);
        if (i != 2) write_png8(shot_ / numbered("gap_%03d.png", i), picture);
        write_png8(shot_ / numbered("size_%03d.png", i), i == 2 ? Image8(640, 352, 3) : picture);
        write_png8(shot_ / numbered("cut_%03d.png", i), picture);
    }
    write("cut_002.png", bytes_of(shot_ / "cut_001.png").substr(0, 50000));
    expect_tracked("good_%03d.png");
    expect_refused("gap_%03d.png", {"gap_002.png", "frame 2", "missing"});
    expect_refused("size_%03d.png", {"size_002.png", "frame 2", "640x352"});
    expect_refused("cut_%03d.png", {"cut_002.png", "frame 2"});
    expect_refused("none_%03d.png", {"none_%03d.png"});
}

TEST_F(MediaBadInput, OddButGoodFootageIsTracked) {
    VideoOptions deep = fast(VideoCodec::h265);
    deep.pixel_format = "yuv422p10le";
    transcode("deep.mp4", deep);
    expect_tracked("deep.mp4");
    VideoOptions rgb = fast(VideoCodec::ffv1);
    rgb.pixel_format = "gbrp10le";
    transcode("rgb.mkv", rgb);
    expect_tracked("rgb.mkv");
    transcode("with space\\nand newline.mkv", fast(VideoCodec::h264));  // "\\n" is TOML's own escape
    fs::rename(shot_ / "with space\\nand newline.mkv", shot_ / "with space\nand newline.mkv");
    expect_tracked("with space\\nand newline.mkv");
}

/// The plate is the truth: in a lossless render every sample outside the touched blocks is the footage's own.
TEST_F(MediaBadInput, LosslessRenderKeepsUntouchedSamples) {
    fs::copy_file(sample_footage, shot_ / "plate.mp4");
    const std::string scene = (shot_ / "table.toml").string();
    ASSERT_TRUE(succeeded(run_matchlight({"track", scene})));
    std::string text = bytes_of(sample_scene);
    text.replace(text.find("\"h264\""), 6, "\"ffv1\"");
    std::ofstream(shot_ / "table.toml", std::ios::binary | std::ios::trunc) << text;
    const std::string output = (shot_ / "out.mkv").string(), masks = (shot_ / "touched_%04d.png").string();
    ASSERT_TRUE(succeeded(
        run_matchlight({"render", scene, "-o", output, "--frames", "3-4", "--level", "draft", "--touched", masks})));
    const auto footage = FrameSource::open(sample_footage, {}, warnings_);
    const auto rendered = FrameSource::open(output, {}, warnings_);
    EXPECT_EQ(rendered->info().frame_count, 2);
    footage->seek(3);
    for (int number = 3; number <= 4; ++number) {
        const Image8 touched = read_mask(numbered(masks, number));
        const auto before = footage->next(), after = rendered->next();
        ASSERT_TRUE(before && after);
        const AVFrame &a = *before->samples(), &b = *after->samples();
        std::int64_t compared = 0, changed = 0;
        for (int y = 0; y < 360; ++y) {
            for (int x = 0; x < 640; ++x) {
                const bool same = a.data[0][y * a.linesize[0] + x] == b.data[0][y * b.linesize[0] + x];
                if (touched.at(x, y) != 0) {
                    changed += same ? 0 : 1;
                } else {
                    ++compared;
                    ASSERT_TRUE(same) << x << ' ' << y;
                }
            }
        }
        for (int y = 0; y < 180; ++y) {
            for (int x = 0; x < 320; ++x) {
                if ((touched.at(2 * x, 2 * y) | touched.at(2 * x + 1, 2 * y) | touched.at(2 * x, 2 * y + 1) |
                     touched.at(2 * x + 1, 2 * y + 1)) != 0)
                    continue;
                for (int plane = 1; plane < 3; ++plane)
                    ASSERT_EQ(a.data[plane][y * a.linesize[plane] + x], b.data[plane][y * b.linesize[plane] + x]);
            }
        }
        EXPECT_GT(compared, 640 * 360 / 4);
        EXPECT_GT(changed, 1000);
    }
}

TEST_F(MediaBadInput, ADiskThatFillsUpDuringARenderLeavesNothing) {
    fs::copy_file(sample_footage, shot_ / "plate.mp4");
    const std::string scene = (shot_ / "table.toml").string();
    ASSERT_TRUE(succeeded(run_matchlight({"track", scene})));
    const fs::path output = shot_ / "out.mp4";
    RunOptions full;
    full.file_size_limit_bytes = 20000;
    const RunResult result =
        run_matchlight({"render", scene, "-o", output.string(), "--frames", "0-3", "--level", "draft"}, full);
    EXPECT_TRUE(failed_naming(result, {"out.mp4", "frame "}));
    EXPECT_TRUE(nothing_left_of(output));
}

}  // namespace
}  // namespace matchlight::test
