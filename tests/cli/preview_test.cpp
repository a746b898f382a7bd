// The preview shows what render writes, follows its keys, and takes new shaders while it runs.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "media/image_io.h"
#include "preview_window.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

using testing::HasSubstr;

TEST_F(PreviewTest, ShowsWhatRenderWrites) {
    const Image8 of_render = rendered(5);
    EXPECT_TRUE(same(snapshot({"--frame", "5"}), of_render));
    // The same frame by another way there, in a window twice as large, sample by sample.
    const Image8 large = snapshot({"--keys", "end,pageup,right,right,left,right,right,right", "--size", "1280x720"});
    ASSERT_EQ(large.width(), 1280);
    for (int y = 0; y < 720; ++y) {
        for (int x = 0; x < 1280; ++x) {
            ASSERT_TRUE(std::equal(large.pixel(x, y), large.pixel(x, y) + 3, of_render.pixel(x / 2, y / 2)))
                << x << ' ' << y;
        }
    }
}

TEST_F(PreviewTest, LeavesBarsInWindowsOfAnotherShape) {
    const Image8 of_render = rendered(0);
    const Image8 shown = snapshot({"--size", "700x400"});
    ASSERT_EQ(shown.width(), 700);
    ASSERT_EQ(shown.height(), 400);
    // 640 × 360 in 700 × 400 is 700 × 394.
    for (const int y : {0, 1, 2, 397, 398, 399}) {
        for (const std::uint8_t sample : shown.row(y)) ASSERT_EQ(sample, 0) << y;
    }
    EXPECT_NEAR(shown.at(350, 200, 0), of_render.at(320, 180, 0), 24);
}

TEST_F(PreviewTest, KeysSwitchWhatIsDrawn) {
    const Image8 composite = snapshot({});
    const Image8 plate = snapshot({"--keys", "p"});
    EXPECT_FALSE(same(composite, plate));
    EXPECT_TRUE(same(snapshot({"--keys", "p,p"}), composite));
    const Image8 without_shadow = snapshot({"--keys", "s"});
    EXPECT_FALSE(same(without_shadow, composite));
    EXPECT_FALSE(same(without_shadow, plate));
    EXPECT_TRUE(same(snapshot({"--keys", "l,l,l,l"}), composite));
}

TEST_F(PreviewTest, BloomSwitchedOnIsTheScenesBloom) {
    // Light that is bright to objects, so that they send some beyond the threshold.
    const std::string text = bytes_of(scene_);
    const std::string probe = "probe = \"probe.exr\"\n";
    std::ofstream(scene_) << text.substr(0, text.find(probe)) << probe << "exposure_ev = 3\n"
                          << text.substr(text.find(probe) + probe.size());
    const Image8 without = snapshot({});
    const Image8 switched_on = snapshot({"--keys", "b"});
    EXPECT_FALSE(same(without, switched_on));
    // All that spills here comes from objects, or is taken away by them: without it the plate's loss is left.
    EXPECT_FALSE(same(snapshot({"--keys", "b,d"}), switched_on));
    append_to_scene("\n[effects]\nbloom = \"auto\"\n");
    EXPECT_TRUE(same(rendered(0), switched_on));
    EXPECT_TRUE(same(snapshot({"--keys", "b"}), without));
}

TEST_F(PreviewTest, PrintsThePassesAndTheKeys) {
    snapshot({"--keys", "right,e,h"});
    EXPECT_THAT(result_.standard_output, HasSubstr("frame 1\n"));
    EXPECT_THAT(result_.standard_output, HasSubstr("surface "));
    EXPECT_THAT(result_.standard_output, HasSubstr("pagedown     ten frames on"));
    // Programs get the result alone.
    snapshot({"--keys", "right,e", "--json"});
    EXPECT_EQ(nlohmann::json::parse(result_.standard_output).at("frame").get<int>(), 1);
}

TEST_F(PreviewTest, PutsTheFrameOnTheScreenAndTakesNewShaders) {
    const fs::path shaders = scratch_ / "shaders";
    fs::copy(fs::path(MATCHLIGHT_SOURCE_DIR) / "shaders", shaders, fs::copy_options::recursive);
    options_.environment["MATCHLIGHT_SHADERS"] = shaders;
    RunningMatchlight preview(call_of(scene_, {"--size", "640x360", "--keys", "tab,right,right"}), options_);
    const Image8 before = rendered(2);
    EXPECT_TRUE(display_.comes_to_show(before));

    const fs::path shader = shaders / "composite/composite.frag";
    const std::string good = bytes_of(shader);
    const std::string grey = good.substr(0, good.rfind('}')) + "    if (touched) composited_code.rgb = vec3(0.5);\n}\n";
    std::ofstream(shader) << grey;
    const Image8 greyed = rendered(2);
    EXPECT_FALSE(same(greyed, before));
    EXPECT_TRUE(display_.comes_to_show(greyed));

    // Broken, the picture stays; mended, it is as it was.
    std::ofstream(shader) << good << "\nthis is no shader\n";
    std::this_thread::sleep_for(std::chrono::seconds(1));  // files are looked at three times a second
    EXPECT_TRUE(display_.comes_to_show(greyed));
    std::ofstream(shader) << good;
    EXPECT_TRUE(display_.comes_to_show(before));

    preview.send(SIGTERM);
    const RunResult result = preview.wait();
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.standard_output, HasSubstr("new: common/fullscreen.vert + composite/composite.frag"));
    EXPECT_THAT(result.standard_output, HasSubstr("composite.frag: does not compile"));
    EXPECT_THAT(result.standard_error, HasSubstr("stopped by a signal"));
}

TEST_F(PreviewTest, PlaysToTheEndAndQuits) {
    RunningMatchlight preview(call_of(scene_, {"--size", "640x360", "--keys", "tab,space"}), options_);
    EXPECT_TRUE(display_.comes_to_show(rendered(11)));
    preview.send(SIGTERM);
    EXPECT_EQ(preview.wait().status, 1);
    const RunResult quit = run_matchlight(call_of(scene_, {"--keys", "right,l,r,left,q"}), options_);
    EXPECT_TRUE(succeeded(quit));
    EXPECT_LT(quit.seconds, 60);
}

TEST_F(PreviewTest, ScriptsShowWhatRenderWritesAmongThePanels) {
    const fs::path first = scratch_ / "first.png", fifth = scratch_ / "fifth.png", plate = scratch_ / "plate.png";
    played("wait_idle\nkey 1\nwait_idle\nscreenshot " + first.string() +
               "\ndrag 50 640 410 640 4\nwait_idle\nscreenshot " + fifth.string() +
               "\nclick view.plate\nwait_idle\nscreenshot " + plate.string(),
           {"--size", "1280x720"});
    EXPECT_TRUE(same(part_of(read_rgb8(first), whole_pixels_at), rendered(0)));
    EXPECT_TRUE(same(part_of(read_rgb8(fifth), whole_pixels_at), rendered(5)));
    EXPECT_TRUE(same(part_of(read_rgb8(plate), whole_pixels_at), snapshot({"--frame", "5", "--keys", "p"})));
}

TEST_F(PreviewTest, ControlsAreInTheWindowAndDoNotOverlap) {
    for (const auto& [size, width, height] : {std::tuple("1280x720", 1280, 720), std::tuple("1280x1024", 1280, 1024)}) {
        std::string script = "wait_idle\nshow objects\nclick object[0]\nwait_idle\ncontrols\n";
        for (const char* panel : {"light", "lens", "effects", "passes"}) {
            script += std::string("show ") + panel + "\nwait_idle\ncontrols\n";
        }
        std::istringstream lines(played(script, {"--size", size}));
        std::vector<Region> places;
        int panels = 0;
        for (std::string word, name, rest; lines >> word;) {
            if (word != "control") continue;
            Region place, seen;
            lines >> name >> rest >> place.x >> place.y >> place.width >> place.height >> rest >> seen.x >> seen.y >>
                seen.width >> seen.height;
            std::getline(lines, rest);
            if (name == "view.composite") {  // the first of a frame
                ++panels;
                places.clear();
            }
            EXPECT_EQ(rest, "") << name << " has its text cut off";
            EXPECT_EQ(place, seen) << name;
            EXPECT_EQ(place, place.intersected({0, 0, width, height})) << name;
            for (const Region& other : places) EXPECT_TRUE(place.intersected(other).empty()) << name;
            places.push_back(place);
        }
        EXPECT_EQ(panels, 5);
    }
}

/// Less the line below the picture, which tells times.
Image8 without_status(const Image8& window) {
    Image8 above(window.width(), window.height() - 26, 3);
    std::ranges::copy_n(window.samples().begin(), std::ssize(above.samples()), above.samples().begin());
    return above;
}

TEST_F(PreviewTest, WhatIsDrawnInPartsIsTheWholeWindow) {
    const fs::path by_parts = scratch_ / "parts.png", at_once = scratch_ / "once.png";
    played(
        "wait_idle\nshow light\nmove 950 200\nmove 200 60\nshow lens\nkey h\nmove 400 300\nkey h\nkey tab\nkey tab\n"
        "show effects\nset effects.bloom auto\nwait_idle\nkey ctrl+z\nwait_idle\nclick view.wipe\ndrag 450 300 300 300 "
        "4\n"
        "click view.wipe\nmove 640 700\nwait_idle\nscreenshot " +
            by_parts.string(),
        {"--size", "1280x720"});
    played(
        "wait_idle\nshow effects\nmove 640 700\nwait_idle\nset effects.bloom auto\nkey ctrl+z\nmove 640 "
        "700\nwait_idle\n"
        "screenshot " +
            at_once.string(),
        {"--size", "1280x720"});
    EXPECT_TRUE(same(without_status(read_rgb8(by_parts)), without_status(read_rgb8(at_once))));
}

TEST_F(PreviewTest, WhatTakesLongIsGivenUpAndThePictureStays) {
    const fs::path before = scratch_ / "before.png", after = scratch_ / "after.png", button = scratch_ / "button.png";
    const std::string out =
        played("wait_idle\nset level preview\nwait_idle\nscreenshot " + before.string() +
                   "\nset level final\nwait_busy\nkey escape\nwait_idle\nmeasure given_up\n"
                   "screenshot " +
                   after.string() +
                   "\nset level preview\nset level final\nwait_busy\nclick give_up\nwait_idle\nset level preview\n"
                   "wait_idle\nmeasure afterwards\nscreenshot " +
                   button.string(),
               {"--size", "1280x720"});
    EXPECT_EQ(std::ranges::count(out, '\n'), 4) << out;
    EXPECT_THAT(out, HasSubstr("given up: the picture stays"));
    const Region picture{0, 40, 900, 530};
    EXPECT_TRUE(same(part_of(read_rgb8(after), picture), part_of(read_rgb8(before), picture)));
    EXPECT_TRUE(same(part_of(read_rgb8(button), picture), part_of(read_rgb8(before), picture)));
}

TEST_F(PreviewTest, WrongScriptsAreToldByTheirLine) {
    for (const auto& [script, words] : std::vector<std::pair<std::string, std::vector<std::string>>>{
             {"wait_idle\nklick 3 4\n", {"hand.txt:2", "'klick'", "click"}},
             {"\n# remark\nclick 3 x\n", {"hand.txt:3", "'x'"}},
             {"key bogus\n", {"hand.txt:1", "'bogus'"}},
             {"set \"bloom on\n", {"hand.txt:1", "quote"}},
             {"wait_idle\nset bogus on\nwait_idle\n", {"hand.txt:2", "'bogus'"}},
             {"wait_idle\nshow bogus\n", {"hand.txt:2", "'bogus'", "Effects"}},
             {"slide level much\n", {"hand.txt:1", "'much'"}},
             {"wait_idle\nslide bogus 0.5\n", {"hand.txt:2", "'bogus'"}}}) {
        const fs::path file = scratch_.write("hand.txt", script);
        EXPECT_TRUE(failed_naming(run_matchlight(call_of(scene_, {"--script", file}), options_), words)) << script;
    }
}

TEST_F(PreviewTest, BadInputsAreToldInOneLine) {
    const fs::path output = scratch_ / "out.png";
    RunOptions nowhere = options_;
    nowhere.environment["DISPLAY"] = "";
    nowhere.environment["WAYLAND_DISPLAY"] = "";
    EXPECT_TRUE(failed_naming(run_matchlight(call_of(scene_, {"--snapshot", output}), nowhere),
                              {"window", "GLFW", "DISPLAY", "xvfb-run", "matchlight render"}));
    EXPECT_TRUE(failed_naming(run_matchlight(call_of(scene_, {"--frame", "12", "--snapshot", output}), options_),
                              {"plate.mp4", "frame 12"}));
    EXPECT_TRUE(failed_naming(run_matchlight(call_of(scene_, {"--snapshot", scratch_ / "out.jpg"}), options_),
                              {"out.jpg", ".png"}));
    EXPECT_TRUE(failed_naming(run_matchlight(call_of(scene_, {"--snapshot", scene_}), options_), {"table.toml"}));
    EXPECT_TRUE(
        failed_naming(run_matchlight(call_of(shot_ / "none.toml", {"--snapshot", output}), options_), {"none.toml"}));
    EXPECT_TRUE(nothing_left_of(output));
    for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
             {"--keys", "b,bogus"}, {"--size", "12"}, {"--size", "0x5"}, {"--size", "5x5x5"}, {"--frame", "-1"}}) {
        EXPECT_TRUE(refused_call(run_matchlight(call_of(scene_, wrong), options_))) << wrong[1];
    }
}

}  // namespace
}  // namespace matchlight::test
