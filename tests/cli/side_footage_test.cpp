// Mattes and depths that do not go with the footage, as `matchlight render` answers them.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

constexpr int footage_frames = 12;

class SideFootageFiles : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
        ASSERT_TRUE(succeeded(run_matchlight({"track", scene_})));
    }
    void write_pictures(const std::string& pattern, int frames, int width = 640, int height = 360) const {
        const Image16 white(width, height, 1, 65535);
        for (int i = 0; i < frames; ++i) write_png16(numbered(shot_ / pattern, i), white);
    }
    /// The sample's scene with more in its [footage].
    void add_to_footage(const std::string& line) const {
        std::stringstream text;
        text << std::ifstream(scene_).rdbuf();
        std::string scene = text.str();
        const std::string section = "[footage]\n";
        scene.insert(scene.find(section) + section.size(), line + "\n");
        std::ofstream(scene_) << scene;
    }
    RunResult render() const {
        return run_matchlight(
            {"render", scene_, "-o", scratch_ / "out_%03d.png", "--frames", "3-3", "--level", "draft"});
    }
    void expect_refused(const std::vector<std::string>& words) const {
        EXPECT_TRUE(failed_naming(render(), words));
        EXPECT_TRUE(nothing_left_of(scratch_ / "out_%03d.png"));
    }

    fs::path shot_, scene_;
};

TEST_F(SideFootageFiles, AWhiteMatteGivesThePlateBack) {
    write_pictures("matte_%03d.png", footage_frames);
    add_to_footage("matte = \"matte_%03d.png\"");
    const RunResult result = run_matchlight(
        {"render", scene_, "-o", scratch_ / "out_%03d.png", "--frames", "3-3", "--level", "draft", "--json"});
    ASSERT_TRUE(succeeded(result));
    EXPECT_NE(result.standard_output.find("\"touched_pixels\": 0"), std::string::npos) << result.standard_output;
}

TEST_F(SideFootageFiles, TooFewFramesAreAnErrorAndTooManyAWarning) {
    add_to_footage("matte = \"matte_%03d.png\"");
    write_pictures("matte_%03d.png", footage_frames - 1);
    expect_refused({"matte_%03d.png", "has 11 frames", "12"});
    write_pictures("matte_%03d.png", footage_frames + 1);
    const RunResult result = render();
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"matte_%03d.png", "13"}));
}

TEST_F(SideFootageFiles, AGapAnotherSizeAndAnEmptyFileAreErrors) {
    add_to_footage("matte = \"matte_%03d.png\"");
    write_pictures("matte_%03d.png", footage_frames + 1);
    fs::remove(shot_ / "matte_005.png");
    expect_refused({"matte_005.png", "missing"});
    write_pictures("matte_%03d.png", footage_frames, 320, 180);
    expect_refused({"matte_%03d.png", "320×180"});
    write_pictures("matte_%03d.png", footage_frames);
    std::ofstream(shot_ / "matte_003.png", std::ios::trunc).close();
    expect_refused({"matte_003.png"});
}

TEST_F(SideFootageFiles, DepthsThatCannotBeReadAreErrors) {
    add_to_footage("depth = \"depth_%03d.exr\"");
    const ImageF depth(640, 360, 1, 1.0F), small(64, 36, 1, 1.0F);
    const auto write = [&](const ImageF& image, const std::string& channel) {
        for (int i = 0; i < footage_frames; ++i) {
            write_exr(numbered(shot_ / "depth_%03d.exr", i), image.width(), image.height(),
                      {{"", {channel}, &image, false, {}}}, {});
        }
    };
    write(small, "Z");
    expect_refused({"depth_003.exr", "64×36"});
    write(depth, "A");
    expect_refused({"depth_003.exr", "no channel Z"});
    write(depth, "Z");
    std::ofstream(shot_ / "depth_003.exr", std::ios::trunc).close();
    expect_refused({"depth_003.exr"});
    fs::remove(shot_ / "depth_003.exr");
    expect_refused({"depth_003.exr", "missing"});
}

TEST_F(SideFootageFiles, AMatteIsNoOutput) {
    write_pictures("matte_%03d.png", footage_frames);
    add_to_footage("matte = \"matte_%03d.png\"");
    EXPECT_TRUE(failed_naming(run_matchlight({"render", scene_, "-o", shot_ / "matte_%03d.png", "--overwrite"}),
                              {"matte_%03d.png", "is an input"}));
}

}  // namespace
}  // namespace matchlight::test
