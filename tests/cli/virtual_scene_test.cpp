// Scenes without footage, as a user renders them.
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/transfer.h"
#include "core/warnings.h"
#include "media/frame_source.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class VirtualScene : public CommandTest {
protected:
    void SetUp() override {
        folder_ = scratch_.copy_sample("table");
        warnings_.set_quiet(true);
    }
    fs::path write(const std::string& camera, const std::string& rest) {
        const fs::path path = folder_ / "virtual.toml";
        std::ofstream(path) << "[camera]\n"
                            << camera << "orbit = {target = [0, 0, 0.05], radius = 0.6, elevation_deg = 20}\n"
                            << rest;
        return path;
    }
    RunResult render(const fs::path& scene, const fs::path& output, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> call{"render", scene, "-o", output, "--level", "draft"};
        call.insert(call.end(), more.begin(), more.end());
        return run_matchlight(call);
    }

    fs::path folder_;
    Warnings warnings_;
};

const char* const small_clip = "width = 64\nheight = 48\nframes = 5\nfps = 30\n";
const char* const sky_and_ball =
    "[light]\nprobe = \"probe.exr\"\n[background]\nprobe = true\n[[object]]\nshape = \"sphere\"\nscale = "
    "0.2\ntranslate = [0, 0, 0.05]\n";

TEST_F(VirtualScene, ShowsItsBackgroundInExactCodes) {
    const fs::path scene =
        write("width = 7\nheight = 5\nexposure_ev = 1\n", "[background]\ncolor = [0.1, 0.25, 0.6]\n");
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "out_%d.png")));
    const Image8 picture = read_rgb8(scratch_ / "out_0.png");
    ASSERT_EQ(picture.width(), 7);
    ASSERT_EQ(picture.height(), 5);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 7; ++x) {
            EXPECT_EQ(picture.at(x, y, 0), std::lround(255 * srgb_code_from_linear(0.2)));
            EXPECT_EQ(picture.at(x, y, 1), std::lround(255 * srgb_code_from_linear(0.5)));
            EXPECT_EQ(picture.at(x, y, 2), 255);
        }
    }
}

TEST_F(VirtualScene, TheVignetteDarkensTheWholePicture) {
    const fs::path scene =
        write("width = 9\nheight = 7\n",
              "[background]\ncolor = [0.5, 0.5, 0.5]\n[effects]\nvignette = {v1 = -0.5, v2 = 0.1}\n");
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "out_%d.png")));
    const Image8 picture = read_rgb8(scratch_ / "out_0.png");
    for (int y = 0; y < 7; ++y) {
        for (int x = 0; x < 9; ++x) {
            const double r2 = ((x - 4) * (x - 4) + (y - 3) * (y - 3)) / (4.5 * 4.5 + 3.5 * 3.5);
            const double light = 0.5 * (1 - 0.5 * r2 + 0.1 * r2 * r2);
            EXPECT_EQ(picture.at(x, y, 1), std::lround(255 * srgb_code_from_linear(light))) << x << ' ' << y;
        }
    }
}

TEST_F(VirtualScene, GrainIsOnTheWholePicture) {
    const fs::path scene = write("width = 64\nheight = 48\nframes = 2\n",
                                 "[background]\ncolor = [0.25, 0.25, 0.25]\n[effects]\ngrain = {read = 0.02}\n");
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "out_%d.exr")));
    double squares = 0, products = 0;
    const ImageF first = read_exr_part(scratch_ / "out_0.exr", "beauty", {"R", "G", "B"});
    const ImageF second = read_exr_part(scratch_ / "out_1.exr", "beauty", {"R", "G", "B"});
    for (std::size_t i = 0; i < first.samples().size(); ++i) {
        squares += std::pow(first.samples()[i] - 0.25, 2);
        products += (first.samples()[i] - 0.25) * (second.samples()[i] - 0.25);
    }
    const double count = 64 * 48 * 3;
    // Four standard errors.
    EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.02 * 4 / std::sqrt(2 * count));
    EXPECT_NEAR(products / count, 0, 4 * 0.02 * 0.02 / std::sqrt(count));
}

TEST_F(VirtualScene, RendersVideoPicturesAndLayers) {
    const fs::path scene = write(small_clip, sky_and_ball);
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "out.mp4")));
    const auto video = FrameSource::open(scratch_ / "out.mp4", {}, warnings_);
    EXPECT_EQ(video->info().frame_count, 5);
    EXPECT_NEAR(video->info().fps, 30, 1e-6);
    EXPECT_EQ(video->info().format.width, 64);
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "out_%d.exr", {"--frames", "2-2"})));
    const fs::path exr = scratch_ / "out_2.exr";
    const ImageF alpha = read_exr_part(exr, "alpha", {"A"});
    const ImageF plate = read_exr_part(exr, "plate", {"R", "G", "B"});
    const ImageF beauty = read_exr_part(exr, "beauty", {"R", "G", "B"});
    EXPECT_EQ(alpha.at(32, 24), 1);
    EXPECT_EQ(alpha.at(0, 0), 0);
    for (int c = 0; c < 3; ++c) {
        EXPECT_GT(plate.at(0, 0, c), 0);
        EXPECT_EQ(plate.at(0, 0, c), beauty.at(0, 0, c));
    }
    EXPECT_NEAR(read_exr_part(exr, "depth", {"Z"}).at(32, 24), 0.5, 0.02);
}

TEST_F(VirtualScene, RendersAnyFramesInAnyOrderWithTheSameBits) {
    const fs::path scene = write(small_clip, sky_and_ball);
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "all_%d.png")));
    for (const int frame : {3, 0, 4}) {
        const std::string range = std::to_string(frame) + "-" + std::to_string(frame);
        ASSERT_TRUE(succeeded(render(scene, scratch_ / "one_%d.png", {"--frames", range})));
        EXPECT_EQ(bytes_of(numbered(scratch_ / "one_%d.png", frame)),
                  bytes_of(numbered(scratch_ / "all_%d.png", frame)));
    }
    EXPECT_NE(bytes_of(scratch_ / "all_0.png"), bytes_of(scratch_ / "all_2.png"));
}

TEST_F(VirtualScene, TheStudysShotsRender) {
    const fs::path study = scratch_.copy_sample("study");
    int scenes = 0;
    for (const auto& entry : fs::directory_iterator(study)) {
        if (entry.path().extension() != ".toml") continue;
        ++scenes;
        const fs::path output = scratch_ / (entry.path().stem().string() + "_%d.png");
        ASSERT_TRUE(succeeded(render(entry.path(), output, {"--frames", "20-20"}))) << entry.path();
        const Image8 picture = read_rgb8(numbered(output, 20));
        EXPECT_EQ(picture.width(), 800);
        // The head stands in the middle, and differs from what is behind it.
        EXPECT_FALSE(std::equal(picture.pixel(400, 260), picture.pixel(400, 260) + 3, picture.pixel(40, 260)));
    }
    EXPECT_EQ(scenes, 5);
}

TEST_F(VirtualScene, TheShotsOfDepthRender) {
    scratch_.copy_sample("study");  // their probes
    for (const std::string name : {"figures", "room", "world"}) {
        const fs::path shot = scratch_.copy_sample("depth_" + name);
        const fs::path output = scratch_ / (name + "_%d.png");
        const RunResult result = render(shot / (name + ".toml"), output, {"--frames", "0-0"});
        ASSERT_TRUE(succeeded(result)) << name;
        EXPECT_EQ(result.standard_error.find("warning"), std::string::npos) << result.standard_error;
        const Image8 picture = read_rgb8(numbered(output, 0));
        EXPECT_EQ(picture.width(), 512);
        // What stands in the middle differs from what is above it.
        EXPECT_FALSE(std::equal(picture.pixel(256, 256), picture.pixel(256, 256) + 3, picture.pixel(256, 4)));
    }
}

TEST_F(VirtualScene, NeedsNoTrack) {
    const fs::path scene = write(small_clip, sky_and_ball);
    EXPECT_TRUE(
        failed_naming(run_matchlight({"track", scene}), {"virtual.toml", "needs no track", "matchlight render"}));
}

TEST_F(VirtualScene, IsRefusedWithLineAndCure) {
    EXPECT_TRUE(failed_naming(render(write("width = 64\n", ""), scratch_ / "out.mp4"),
                              {"virtual.toml:1", "'height' is missing"}));
    EXPECT_TRUE(
        failed_naming(render(write(small_clip, "[background]\nimage = \"truth_000.png\"\n"), scratch_ / "a.mp4"),
                      {"truth_000.png", "640×360", "64×48"}));
    EXPECT_TRUE(failed_naming(render(write(small_clip, sky_and_ball), scratch_ / "out_%d.png", {"--frames", "5-5"}),
                              {"virtual.toml", "no frame 5"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "a.mp4"));
}

TEST_F(VirtualScene, MetersOnceAndRendersChunksWithTheSameBits) {
    const std::string metered =
        std::string(sky_and_ball) + "[effects]\nexposure = {to_light_s = 0.1, to_dark_s = 0.1}\n";
    const fs::path scene = write(small_clip, metered);
    const fs::path meter = folder_ / "virtual.meter.json";
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "all_%d.png")));
    ASSERT_TRUE(fs::exists(meter));
    const std::string made = bytes_of(meter);
    fs::remove(meter);
    // A chunk meters the whole clip all the same, and the next one takes what it found.
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "one_%d.png", {"--frames", "3-3"})));
    EXPECT_EQ(bytes_of(meter), made);
    const auto written = fs::last_write_time(meter);
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "one_%d.png", {"--frames", "0-2"})));
    EXPECT_EQ(fs::last_write_time(meter), written);
    for (int frame = 0; frame <= 3; ++frame) {
        EXPECT_EQ(bytes_of(numbered(scratch_ / "one_%d.png", frame)),
                  bytes_of(numbered(scratch_ / "all_%d.png", frame)));
    }
    // How it is encoded does not matter to the meter; what it looks at does.
    write(small_clip, metered + "[output]\ncrf = 20\n");
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "crf.mp4")));
    EXPECT_EQ(fs::last_write_time(meter), written);
    write(std::string(small_clip) + "vertical_fov_deg = 60\n", metered);
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "wide_%d.png", {"--frames", "0-0"})));
    EXPECT_NE(bytes_of(meter), made);
}

TEST_F(VirtualScene, PlacesTheMeteredAverageAtTheKey) {
    const char* const one_pixel = "width = 1\nheight = 1\n";
    for (const double key : {0.18, 0.5}) {
        for (const char* const light : {"[1e-8, 1e-8, 1e-8]", "[0.3, 0.3, 0.3]", "[65504, 65504, 65504]"}) {
            const fs::path scene = write(
                one_pixel, fmt::format("[background]\ncolor = {}\n[effects]\nexposure = {{key = {}}}\n", light, key));
            ASSERT_TRUE(succeeded(render(scene, scratch_ / "out_%d.png", {"--overwrite"})));
            EXPECT_NEAR(read_rgb8(scratch_ / "out_0.png").at(0, 0, 1), 255 * srgb_code_from_linear(key), 0.51) << light;
        }
    }
    EXPECT_TRUE(
        failed_naming(render(write(one_pixel, "[effects]\nexposure = {mode = \"matched\"}\n"), scratch_ / "a.mp4"),
                      {"virtual.toml:6", "no footage to match"}));
}

TEST_F(VirtualScene, ExposesFootageAnewOnlyWhenAsked) {
    const fs::path scene = folder_ / "table.toml";
    ASSERT_TRUE(succeeded(run_matchlight({"track", scene})));
    const std::string plain = bytes_of(scene);
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "off_%d.png", {"--frames", "4-4"})));
    std::ofstream(scene, std::ios::trunc) << plain << "[effects]\nexposure = \"auto\"\n";
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "auto_%d.png", {"--frames", "4-4"})));
    EXPECT_EQ(read_rgb8(scratch_ / "auto_4.png").samples().size(), read_rgb8(scratch_ / "off_4.png").samples().size());
    const Image8 off = read_rgb8(scratch_ / "off_4.png"), matched = read_rgb8(scratch_ / "auto_4.png");
    EXPECT_TRUE(std::equal(off.samples().begin(), off.samples().end(), matched.samples().begin()));
    EXPECT_FALSE(fs::exists(folder_ / "table.meter.json"));
    std::ofstream(scene, std::ios::trunc)
        << plain << "[effects]\nexposure = {mode = \"simulated\", compensation_ev = -3}\n";
    ASSERT_TRUE(succeeded(render(scene, scratch_ / "dark_%d.png", {"--frames", "4-4"})));
    const Image8 dark = read_rgb8(scratch_ / "dark_4.png");
    std::int64_t sum_off = 0, sum_dark = 0;
    for (const std::uint8_t code : off.samples()) sum_off += code;
    for (const std::uint8_t code : dark.samples()) sum_dark += code;
    EXPECT_LT(sum_dark, sum_off / 2);
    EXPECT_LT(dark.at(2, 2, 1), off.at(2, 2, 1));  // the plate too
}

}  // namespace
}  // namespace matchlight::test
