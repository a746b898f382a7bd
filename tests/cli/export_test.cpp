// `matchlight export`: every format written whole, and what is refused.
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Four frames at 30 a second over one tag; the third has no pose.
json made_solve() {
    json solve = json::parse(R"({"matchlight_solve": 1,
        "footage": {"file": "my clip.mp4", "width": 320, "height": 180, "frames": 4},
        "lens": {"camera_matrix": [[280, 0, 161.5], [0, 281, 88], [0, 0, 1]],
                 "distortion": [-0.2, 0.05, 0, 0], "model": "radtan"},
        "rig": [{"id": 3, "size_m": 0.1, "world_from_tag": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}],
        "frames": []})");
    for (int i = 0; i < 4; ++i) {
        json frame{{"frame", i}, {"time_s", i / 30.0}, {"camera_from_world", nullptr}};
        if (i != 2) {
            frame["camera_from_world"] = {{1, 0, 0, 0.01 * i}, {0, -1, 0, 0}, {0, 0, -1, 0.5}, {0, 0, 0, 1}};
            frame["tags"] = {3};
        }
        solve["frames"].push_back(frame);
    }
    return solve;
}

class ExportCommand : public CommandTest {
protected:
    void SetUp() override { solve_ = scratch_.write("my clip.solve.json", made_solve().dump()); }

    RunResult run(const std::string& output, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{"export", solve_.string(), "-o", (scratch_ / output).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_matchlight(arguments);
    }
    RunResult run_changed(const std::string& output, const std::function<void(json&)>& change,
                          const std::vector<std::string>& more = {}) const {
        json solve = made_solve();
        change(solve);
        scratch_.write("my clip.solve.json", solve.dump());
        return run(output, more);
    }

    fs::path solve_;
};

TEST_F(ExportCommand, WritesEveryFormat) {
    const std::vector<std::pair<std::string, std::string>> starts{
        {"c.chan", "0 "}, {"c.gltf", "{"}, {"c.glb", "glTF"}, {"c.usda", "#usda 1.0\n"}, {"c.csv", "frame,time_s,"}};
    for (const auto& [name, start] : starts) {
        const RunResult result = run(name, {"--json"});
        EXPECT_TRUE(succeeded(result)) << name;
        EXPECT_TRUE(bytes_of(scratch_ / name).starts_with(start)) << name;
        EXPECT_TRUE(warned_of(result, {"1 frames have no pose"})) << name;
        const json report = json::parse(result.standard_output);
        EXPECT_EQ(report["posed"], 3);
        EXPECT_EQ(report["frames"], 4);
        EXPECT_EQ(report["fps"], 30);
        EXPECT_EQ(report["format"], name == "c.usda" ? "usd" : name.substr(2));
    }
    EXPECT_TRUE(succeeded(run("colmap")));
    for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"}) {
        EXPECT_TRUE(fs::exists(scratch_ / "colmap" / name)) << name;
    }
    // A space would end a name in images.txt.
    EXPECT_NE(bytes_of(scratch_ / "colmap" / "images.txt").find(" 1 my_clip_000003.png\n"), std::string::npos);
}

TEST_F(ExportCommand, SaysWhatAFormatLeavesOut) {
    EXPECT_TRUE(warned_of(run("a.chan"), {"a.chan", "distortion", "--stmap undistort"}));
    EXPECT_TRUE(
        warned_of(run("b.chan"), {"b.chan", "principal point", "+2.00 px right", "-1.50 px down", "--centred"}));
    const json chan = json::parse(run("c.chan", {"--json", "-q"}).standard_output);
    EXPECT_EQ(chan["left_out"].size(), 3u);
    EXPECT_EQ(json::parse(run("d.chan", {"--json", "-q", "--centred"}).standard_output)["left_out"].size(), 1u);
    EXPECT_EQ(json::parse(run("c.usda", {"--json", "-q"}).standard_output)["left_out"].size(), 1u);
    EXPECT_EQ(json::parse(run("c", {"--json", "-q"}).standard_output)["left_out"].size(), 0u);
    const RunResult fisheye =
        run_changed("f.gltf", [](json& s) { s["lens"]["model"] = "fisheye"; }, {"--frames", "0-1"});
    EXPECT_TRUE(succeeded(fisheye));
    EXPECT_TRUE(warned_of(fisheye, {"f.gltf", "fisheye projection"}));
}

TEST_F(ExportCommand, TakesARangeAndNumbers) {
    EXPECT_TRUE(succeeded(run("c.chan", {"--frames", "1-3", "--first", "1001"})));
    const std::string text = bytes_of(scratch_ / "c.chan");
    EXPECT_TRUE(text.starts_with("1002 "));
    EXPECT_NE(text.find("\n1004 "), std::string::npos);
    EXPECT_TRUE(failed_naming(run("d.chan", {"--frames", "2"}), {"my clip.solve.json", "no frame of the range"}));
    EXPECT_TRUE(succeeded(run("one.glb", {"--frames", "3"})));
    EXPECT_TRUE(refused_call(run("e.chan", {"--fps", "nan"})));
    EXPECT_TRUE(refused_call(run("e.chan", {"--sensor-width-mm", "0"})));
    EXPECT_TRUE(refused_call(run("e.chan", {"--frames", "3-1"})));
}

TEST_F(ExportCommand, ReplacesNothingUnlessTold) {
    ASSERT_TRUE(succeeded(run("c.usda")));
    ASSERT_TRUE(succeeded(run("colmap")));
    const std::string before = bytes_of(scratch_ / "c.usda");
    EXPECT_TRUE(failed_naming(run("c.usda", {"--frames", "0"}), {"c.usda", "--overwrite"}));
    EXPECT_TRUE(failed_naming(run("colmap"), {"cameras.txt", "--overwrite"}));
    EXPECT_EQ(bytes_of(scratch_ / "c.usda"), before);
    EXPECT_TRUE(succeeded(run("c.usda", {"--frames", "0", "--overwrite"})));
    EXPECT_NE(bytes_of(scratch_ / "c.usda"), before);
    EXPECT_TRUE(succeeded(run("colmap", {"--overwrite"})));
    EXPECT_TRUE(failed_naming(run("no/such/folder/c.usda"), {"c.usda"}));
    const std::string solve = bytes_of(solve_);
    EXPECT_TRUE(failed_naming(run("my clip.solve.json", {"--format", "csv", "--overwrite"}), {"the input"}));
    EXPECT_EQ(bytes_of(solve_), solve);
}

TEST_F(ExportCommand, RefusesOtherFiles) {
    EXPECT_TRUE(failed_naming(run("c.abc"), {"c.abc", ".abc", ".usda"}));
    EXPECT_TRUE(failed_naming(run("c.exr"), {"c.exr", "--stmap"}));
    EXPECT_TRUE(failed_naming(run("c.xyz"), {"c.xyz", "--format"}));
    EXPECT_TRUE(succeeded(run("c.xyz", {"--format", "chan"})));
    EXPECT_TRUE(refused_call(run("d.xyz", {"--format", "maya"})));
    EXPECT_TRUE(failed_naming(run("m.png", {"--stmap", "undistort"}), {"m.png", ".exr"}));
    EXPECT_TRUE(refused_call(run("m.exr", {"--stmap", "sideways"})));
    for (const char* overscan : {"0.5", "9", "nan", "inf", "much"}) {
        EXPECT_TRUE(refused_call(run("m.exr", {"--stmap", "undistort", "--overscan", overscan}))) << overscan;
    }
}

TEST_F(ExportCommand, RefusesBadSolvesInOneLine) {
    const std::string file = "my clip.solve.json";
    EXPECT_TRUE(failed_naming(run_changed("c.chan", [](json& s) { s["frames"] = json::array(); }),
                              {file, "no frame of the range"}));
    EXPECT_TRUE(failed_naming(run_changed("c.chan", [](json& s) { s["matchlight_solve"] = 9; }), {file, "version 9"}));
    EXPECT_TRUE(failed_naming(run_changed("c.gltf", [](json& s) { s["frames"][1]["camera_from_world"][0][0] = 3; }),
                              {file, "frame 1"}));
    EXPECT_TRUE(failed_naming(
        run_changed("m.exr", [](json& s) { s["lens"]["camera_matrix"][1][1] = 0; }, {"--stmap", "undistort"}),
        {file, "focal length"}));
    EXPECT_TRUE(failed_naming(run_changed("m.exr",
                                          [](json& s) {
                                              s["footage"]["width"] = 65000;
                                              s["footage"]["height"] = 65000;
                                          },
                                          {"--stmap", "redistort"}),
                              {"m.exr", "too large"}));
    EXPECT_TRUE(failed_naming(
        run_changed("colmap", [](json& s) { s["lens"]["distortion"] = {0, 0, 0, 0, 0, 0, 0, 0, 0.01, 0, 0, 0}; }),
        {file, "thin-prism"}));
    EXPECT_FALSE(fs::exists(scratch_ / "colmap"));
    EXPECT_TRUE(failed_naming(run_changed("c.glb", [](json& s) { s["frames"][3]["camera_from_world"][2][3] = 1e200; }),
                              {file, "frame 3", "farther"}));
    EXPECT_TRUE(failed_naming(run_changed("c.glb", [](json& s) { s["frames"][3]["time_s"] = 1e300; }), {"frame 3"}));
    EXPECT_TRUE(failed_naming(run_changed("c.usda",
                                          [](json& s) {
                                              s["frames"][3]["frame"] = 4000000000000000000;
                                              s["footage"].erase("frames");
                                          }),
                              {file, "thousand million"}));
    for (const std::string& bytes : {std::string(), std::string("\0\x01\x02", 3), std::string(1000, '[')}) {
        scratch_.write(file, bytes);
        EXPECT_TRUE(failed_naming(run("c.usda"), {file}));
    }
    for (const char* name : {"c.chan", "c.gltf", "c.usda", "m.exr"}) EXPECT_TRUE(nothing_left_of(scratch_ / name));
}

TEST_F(ExportCommand, WritesStmapsOfSolvesAndCalibrations) {
    const RunResult undistort = run("u.exr", {"--stmap", "undistort", "--json"});
    ASSERT_TRUE(succeeded(undistort));
    const json picture = json::parse(undistort.standard_output);
    EXPECT_GT(picture["width"], 320);
    EXPECT_EQ(picture["unreachable_pixels"], 0);
    EXPECT_EQ(picture["undistorted"]["uncovered_plate_pixels"], 0);
    EXPECT_EQ(picture["undistorted"]["width"], picture["width"]);
    EXPECT_EQ(picture["width"], 320 + 2 * picture["undistorted"]["margin_px"][0].get<int>());
    const ImageF map = read_exr_part(scratch_ / "u.exr", "stmap", {"R", "G", "B"});
    EXPECT_EQ(map.width(), picture["width"]);
    EXPECT_EQ(map.height(), picture["height"]);

    ASSERT_TRUE(succeeded(run("r.exr", {"--stmap", "redistort"})));
    const ImageF back = read_exr_part(scratch_ / "r.exr", "stmap", {"R", "G"});
    EXPECT_EQ(back.width(), 320);
    EXPECT_EQ(back.height(), 180);

    const std::string shot = scratch_.copy_sample("table").string();
    const RunResult lens = run_matchlight({"export", shot + "/camera.yaml", "-o", (scratch_ / "t.exr").string(),
                                           "--stmap", "undistort", "--overscan", "1.25", "--json"});
    ASSERT_TRUE(succeeded(lens));
    EXPECT_EQ(json::parse(lens.standard_output)["width"], 800);
    EXPECT_TRUE(failed_naming(run_matchlight({"export", shot + "/camera.yaml", "-o", (scratch_ / "t.chan").string()}),
                              {"camera.yaml", "no poses"}));
}

TEST_F(ExportCommand, AFullDiskLeavesNothingBehind) {
    RunOptions options;
    options.file_size_limit_bytes = 4096;
    EXPECT_TRUE(failed_naming(
        run_matchlight({"export", solve_.string(), "-o", (scratch_ / "u.exr").string(), "--stmap", "undistort"},
                       options),
        {"u.exr"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "u.exr"));
}

}  // namespace
}  // namespace matchlight::test
