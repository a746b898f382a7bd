// Renders under the system's adversities: outputs that exist, full disks, signals, odd paths, other locales.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include <unistd.h>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

/// The sample shot, tracked, in a scratch folder.
class SystemTest : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
        ASSERT_TRUE(succeeded(run_matchlight({"track", scene_})));
    }

    /// `matchlight render SCENE -o OUTPUT more…`, at a level that is quick to begin.
    std::vector<std::string> render_call(const fs::path& output, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> call{"render", scene_, "--level", level_, "-o", output};
        call.insert(call.end(), more.begin(), more.end());
        return call;
    }

    /// All twelve frames as PNG, undisturbed, in a folder of this name.
    fs::path render_all(const std::string& folder) const {
        fs::create_directories(scratch_ / folder);
        EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / folder / "out_%03d.png"))));
        return scratch_ / folder;
    }

    static std::string frame_name(int frame) {
        return "out_" + std::string(frame < 10 ? "00" : "0") + std::to_string(frame) + ".png";
    }

    /// For tests that stop a run halfway: frames that take a while.
    void draw_slowly() { level_ = "preview"; }

    static constexpr int frame_count = 12;
    std::string level_ = "draft";
    fs::path shot_;
    fs::path scene_;
};

TEST_F(SystemTest, AnOutputThatExistsIsKeptUnlessOverwriteIsSaid) {
    const fs::path video = scratch_.write("out.mp4", "precious");
    EXPECT_TRUE(failed_naming(run_matchlight(render_call(video, {"--frames", "0-0"})), {"out.mp4", "exists"}));
    EXPECT_EQ(bytes_of(video), "precious");
    EXPECT_TRUE(succeeded(run_matchlight(render_call(video, {"--frames", "0-0", "--overwrite"}))));
    EXPECT_NE(bytes_of(video), "precious");

    // One frame of a sequence is enough to refuse it, before any other frame is drawn.
    const fs::path frame = scratch_.write("out_001.png", "precious");
    const fs::path pattern = scratch_ / "out_%03d.png";
    EXPECT_TRUE(failed_naming(run_matchlight(render_call(pattern, {"--frames", "0-1"})), {"out_001.png", "exists"}));
    EXPECT_EQ(bytes_of(frame), "precious");
    EXPECT_FALSE(fs::exists(scratch_ / "out_000.png"));
}

TEST_F(SystemTest, TheFootageIsNeverTheOutput) {
    const std::string plate = bytes_of(shot_ / "plate.mp4");
    fs::create_symlink(shot_ / "plate.mp4", shot_ / "alias.mp4");
    fs::create_hard_link(shot_ / "plate.mp4", shot_ / "twin.mp4");
    for (const char* name : {"plate.mp4", "../table/plate.mp4", "alias.mp4", "twin.mp4"}) {
        const fs::path output = shot_ / name;
        EXPECT_TRUE(failed_naming(run_matchlight(render_call(output, {"--overwrite"})), {"input"})) << name;
        EXPECT_EQ(bytes_of(shot_ / "plate.mp4"), plate) << name;
    }
}

TEST_F(SystemTest, TheSolveIsNeverWrittenOverAnInput) {
    const std::string camera = bytes_of(shot_ / "camera.yaml");
    EXPECT_TRUE(failed_naming(run_matchlight({"track", scene_, "-o", shot_ / "camera.yaml"}), {"camera.yaml"}));
    EXPECT_EQ(bytes_of(shot_ / "camera.yaml"), camera);
}

TEST_F(SystemTest, AFolderThatCannotBeWrittenIsNamedBeforeTheFirstFrame) {
    const RunResult missing = run_matchlight(render_call(scratch_ / "no folder" / "out.mp4"));
    EXPECT_TRUE(failed_naming(missing, {"no folder", "out.mp4"}));
    EXPECT_FALSE(fs::exists(scratch_ / "no folder"));
    // /proc takes no new files, not even from the superuser.
    EXPECT_TRUE(failed_naming(run_matchlight(render_call("/proc/out.mp4")), {"/proc/out.mp4"}));
    EXPECT_TRUE(failed_naming(run_matchlight(render_call("/proc/out_%03d.png")), {"/proc/out_"}));
    EXPECT_TRUE(
        failed_naming(run_matchlight({"track", scene_, "-o", "/proc/table.solve.json"}), {"/proc/table.solve.json"}));
}

TEST_F(SystemTest, OfTwoRunsOnOneOutputTheSecondIsRefused) {
    draw_slowly();
    const fs::path output = scratch_ / "out.mp4";
    RunningMatchlight first(render_call(output));
    ASSERT_TRUE(first.wait_for_file(scratch_ / ".out.mp4.lock"));
    EXPECT_TRUE(failed_naming(run_matchlight(render_call(output, {"--overwrite"})), {"out.mp4", "another run"}));
    EXPECT_TRUE(succeeded(first.wait()));
    EXPECT_TRUE(fs::exists(output));
    EXPECT_FALSE(fs::exists(scratch_ / ".out.mp4.lock"));
}

TEST_F(SystemTest, AFullDiskFailsAtItsFrameAndKeepsTheFramesBefore) {
    const fs::path whole = render_all("whole");
    // A frame that is larger than the one before it: with room for that one only, the disk "fills" at the second.
    int full_frame = 1;
    const auto size = [&](int frame) { return fs::file_size(whole / frame_name(frame)); };
    while (full_frame < frame_count && size(full_frame) <= size(full_frame - 1)) ++full_frame;
    ASSERT_LT(full_frame, frame_count) << "the frames only get smaller: choose another limit";
    const int kept_frame = full_frame - 1;

    fs::create_directories(scratch_ / "full");
    RunOptions options;
    options.file_size_limit_bytes = size(kept_frame);
    const RunResult result = run_matchlight(
        render_call(scratch_ / "full" / "out_%03d.png", {"--frames", std::to_string(kept_frame) + "-11"}), options);
    EXPECT_TRUE(failed_naming(result, {frame_name(full_frame)}));
    EXPECT_EQ(bytes_of(scratch_ / "full" / frame_name(kept_frame)), bytes_of(whole / frame_name(kept_frame)));
    EXPECT_TRUE(nothing_left_of(scratch_ / "full" / frame_name(full_frame)));
}

TEST_F(SystemTest, AFullDiskLeavesNoHalfOutput) {
    RunOptions options;
    options.file_size_limit_bytes = 20000;
    for (const char* name : {"out.mp4", "out.mkv", "out_%03d.exr", "out_%03d.png"}) {
        EXPECT_TRUE(failed_naming(run_matchlight(render_call(scratch_ / name), options), {"out"})) << name;
        EXPECT_TRUE(nothing_left_of(scratch_ / name));
    }
    options.file_size_limit_bytes = 100;
    EXPECT_TRUE(failed_naming(run_matchlight({"track", scene_, "-o", scratch_ / "out.json"}, options), {"out.json"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "out.json"));
    const RunResult probe = run_matchlight(
        {"probe", "convert", shot_ / "probe.exr", "-o", scratch_ / "ball.exr", "--to", "mirrorball"}, options);
    EXPECT_TRUE(failed_naming(probe, {"ball.exr"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "ball.exr"));
}

TEST_F(SystemTest, AResultThatCannotBePrintedIsAFailure) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    RunOptions options;
    options.stdout_path = "/dev/full";
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "info", shot_ / "probe.exr", "--json"}, options), {"output"}));
}

TEST_F(SystemTest, SigtermFinishesTheFrameInHand) {
    draw_slowly();
    const fs::path whole = render_all("whole");
    fs::create_directories(scratch_ / "stopped");
    RunningMatchlight run(render_call(scratch_ / "stopped" / "out_%03d.png"));
    ASSERT_TRUE(run.wait_for_file(scratch_ / "stopped" / frame_name(0)));
    run.send(SIGTERM);
    const RunResult result = run.wait();
    EXPECT_TRUE(failed_naming(result, {}));
    EXPECT_LT(result.seconds, 30);
    int frames = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(scratch_ / "stopped")) {
        EXPECT_EQ(bytes_of(entry.path()), bytes_of(whole / entry.path().filename())) << entry.path();
        ++frames;
    }
    EXPECT_GE(frames, 1);
    EXPECT_LT(frames, frame_count);
}

TEST_F(SystemTest, SigtermLeavesNoHalfVideo) {
    draw_slowly();
    RunningMatchlight run(render_call(scratch_ / "out.mp4"));
    ASSERT_TRUE(run.wait_for_file(scratch_ / "out.part.mp4"));
    run.send(SIGTERM);
    EXPECT_TRUE(failed_naming(run.wait(), {}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "out.mp4"));
}

TEST_F(SystemTest, AKilledRunCanBeRunAgainToTheSameBits) {
    draw_slowly();
    const fs::path whole = render_all("whole");
    fs::create_directories(scratch_ / "killed");
    const fs::path pattern = scratch_ / "killed" / "out_%03d.png";
    RunningMatchlight run(render_call(pattern));
    ASSERT_TRUE(run.wait_for_file(scratch_ / "killed" / frame_name(1)));
    run.send(SIGKILL);
    EXPECT_EQ(run.wait().signal, SIGKILL);
    EXPECT_TRUE(succeeded(run_matchlight(render_call(pattern, {"--overwrite"}))));
    for (int frame = 0; frame < frame_count; ++frame)
        EXPECT_EQ(bytes_of(scratch_ / "killed" / frame_name(frame)), bytes_of(whole / frame_name(frame))) << frame;
    EXPECT_FALSE(fs::exists(scratch_ / "killed" / ".out_%03d.png.lock"));
}

TEST_F(SystemTest, AKilledTrackLeavesTheSolveOfBefore) {
    const fs::path solve = shot_ / "table.solve.json";
    const std::string before = bytes_of(solve);
    RunningMatchlight run({"track", scene_});
    run.send(SIGKILL);
    EXPECT_EQ(run.wait().signal, SIGKILL);
    EXPECT_EQ(bytes_of(solve), before);
    EXPECT_TRUE(succeeded(run_matchlight({"track", scene_})));
    EXPECT_EQ(bytes_of(solve), before);
}

TEST_F(SystemTest, ChunksEqualTheWhole) {
    const fs::path whole = render_all("whole");
    fs::create_directories(scratch_ / "chunks");
    const fs::path pattern = scratch_ / "chunks" / "out_%03d.png";
    for (const char* frames : {"7-11", "0-2", "3-6"})
        EXPECT_TRUE(succeeded(run_matchlight(render_call(pattern, {"--frames", frames}))));
    for (int frame = 0; frame < frame_count; ++frame)
        EXPECT_EQ(bytes_of(scratch_ / "chunks" / frame_name(frame)), bytes_of(whole / frame_name(frame))) << frame;
}

TEST_F(SystemTest, ACommaForADecimalPointChangesNothing) {
    // A locale of its own in the scratch folder, so that none need be installed in the system.
    const std::string locale = scratch_ / "de_DE.UTF-8";
    const std::string make = "localedef -i de_DE -f UTF-8 '" + locale + "' > /dev/null 2>&1";
    ASSERT_EQ(std::system(make.c_str()), 0) << "the Debian package \"locales\" is missing";
    RunOptions options;
    options.environment = {{"LOCPATH", scratch_.path()}, {"LC_ALL", "de_DE.UTF-8"}, {"LANG", "de_DE.UTF-8"}};

    const fs::path solve = shot_ / "table.solve.json";
    const std::string with_point = bytes_of(solve);
    EXPECT_TRUE(succeeded(run_matchlight({"track", scene_}, options)));
    EXPECT_EQ(bytes_of(solve), with_point);

    EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / "point_%03d.png", {"--frames", "5-5"}))));
    EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / "comma_%03d.png", {"--frames", "5-5"}), options)));
    EXPECT_EQ(bytes_of(scratch_ / "comma_005.png"), bytes_of(scratch_ / "point_005.png"));
}

TEST_F(SystemTest, OddPathsAreOnlyPaths) {
    EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / "plain_%03d.png", {"--frames", "0-0"}))));
    const std::string expected = bytes_of(scratch_ / "plain_000.png");
    const fs::path folder = scratch_ / "-v two\nlines & sp\u00e4te \u00c4pfel;$(x)'\"*?";
    fs::copy(shot_, folder);
    EXPECT_TRUE(succeeded(run_matchlight({"track", folder / "table.toml"})));
    EXPECT_TRUE(succeeded(run_matchlight(
        {"render", folder / "table.toml", "--level", level_, "-o", folder / "out_%03d.png", "--frames", "0-0"})));
    EXPECT_EQ(bytes_of(folder / "out_000.png"), expected);
}

TEST_F(SystemTest, APathMayStartWithADash) {
    fs::rename(shot_ / "table.toml", shot_ / "-table.toml");
    RunOptions options;
    options.working_directory = shot_;
    EXPECT_TRUE(succeeded(run_matchlight({"track", "-o", "other.solve.json", "--", "-table.toml"}, options)));
    EXPECT_TRUE(succeeded(run_matchlight({"track", "--", "-table.toml"}, options)));
    const RunResult result = run_matchlight(
        {"render", "--level", level_, "--output=-out_%03d.png", "--frames", "0-0", "--", "-table.toml"}, options);
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(fs::exists(shot_ / "-out_000.png"));
}

TEST_F(SystemTest, AChangedMaterialIsSeenAtOnce) {
    EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / "before_%03d.png", {"--frames", "0-0"}))));
    std::string scene = bytes_of(scene_);
    const std::string model = "model = \"objects.glb\"";
    ASSERT_NE(scene.find(model), std::string::npos);
    scene.replace(scene.find(model), model.size(), model + "\nmaterial = {base_color = [0.0, 0.5, 0.0]}\n#");
    scratch_.write("table/table.toml", scene);
    EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / "after_%03d.png", {"--frames", "0-0"}))));
    EXPECT_NE(bytes_of(scratch_ / "before_000.png"), bytes_of(scratch_ / "after_000.png"));
}

TEST_F(SystemTest, ASolveMadeWithOtherSettingsIsNotUsed) {
    std::string scene = bytes_of(scene_);
    const std::string place = "x = 0.14, y = 0.02";
    ASSERT_NE(scene.find(place), std::string::npos);
    scene.replace(scene.find(place), place.size(), "x = 0.15, y = 0.02");
    scratch_.write("table/table.toml", scene);
    const RunResult result = run_matchlight(render_call(scratch_ / "out_%03d.png", {"--frames", "0-0"}));
    EXPECT_TRUE(failed_naming(result, {"table.solve.json", "[tags]", "matchlight track"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "out_%03d.png"));
    EXPECT_TRUE(succeeded(run_matchlight({"track", scene_})));
    EXPECT_TRUE(succeeded(run_matchlight(render_call(scratch_ / "out_%03d.png", {"--frames", "0-0"}))));
}

TEST_F(SystemTest, ARenderWithoutASolveSaysToTrackFirst) {
    fs::remove(shot_ / "table.solve.json");
    EXPECT_TRUE(failed_naming(run_matchlight(render_call(scratch_ / "out.mp4")), {"table.solve.json", "track"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "out.mp4"));
}

}  // namespace
}  // namespace matchlight::test
