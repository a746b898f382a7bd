// What is changed in the window is what its file says, and what render makes of that file.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "media/image_io.h"
#include "preview_window.h"

namespace matchlight::test {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class PreviewEditTest : public PreviewTest {
protected:
    /// Script lines that wait and then save the window's picture under a name.
    std::string shot(const std::string& name) const {
        return "wait_idle\nscreenshot " + (scratch_ / (name + ".png")).string() + "\n";
    }
    /// The scene's picture in that window, a pixel a pixel.
    Image8 picture(const std::string& name) const {
        return part_of(read_rgb8(scratch_ / (name + ".png")), whole_pixels_at);
    }
    std::string hand(const std::string& script) { return played(script, {"--size", "1280x720"}); }
};

TEST_F(PreviewEditTest, WhatIsSavedRendersAsTheWindowShowedIt) {
    append_to_scene("\n[effects]\nbloom = {strength = 0.6, threshold = 0.3} # as in the film\n");
    hand("wait_idle\nkey 1\n" + shot("first") +
         "show objects\nclick object[0]\nset object[0].translate \"0.02 0 0.01\"\n"
         "click 200 560\nshow light\nset light.exposure_ev 1.5\nset surface.shadow off\n" +
         shot("changed") + "key ctrl+z\nkey ctrl+z\nkey ctrl+z\n" + shot("undone") +
         "key ctrl+shift+z\nkey ctrl+shift+z\nkey ctrl+shift+z\n" + shot("redone") + "key b\n" + shot("without") +
         "key b\n" + shot("last") + "key ctrl+s\nwait_idle");
    EXPECT_FALSE(same(picture("changed"), picture("first")));
    EXPECT_TRUE(same(picture("undone"), picture("first")));
    EXPECT_TRUE(same(picture("redone"), picture("changed")));
    EXPECT_FALSE(same(picture("without"), picture("changed")));
    EXPECT_TRUE(same(picture("last"), picture("changed")));
    const std::string saved = bytes_of(scene_);
    for (const char* line : {"# A table that a camera circles", "translate = [0.02, 0, 0.01]", "exposure_ev = 1.5",
                             "shadow = false", "strength = 0.6, threshold = 0.3", "# as in the film"}) {
        EXPECT_THAT(saved, HasSubstr(line));
    }
    EXPECT_TRUE(same(rendered(0), picture("last")));
}

TEST_F(PreviewEditTest, SwitchesGoBackToWhatTheSceneHad) {
    append_to_scene("\n[effects.dazzle]\nstrength = 3\n");
    const std::string before = bytes_of(scene_);
    hand("wait_idle\nkey d\nwait_idle\nkey ctrl+s\nkey d\nkey x\nkey g\nwait_idle\nkey ctrl+s\nwait_idle");
    EXPECT_THAT(bytes_of(scene_), AllOf(HasSubstr("strength = 3"), HasSubstr("mode = \"simulated\""),
                                        HasSubstr("glare = \"auto\""), Not(HasSubstr("strength = 0"))));
}

TEST_F(PreviewEditTest, ShapesAreAddedAndRemoved) {
    const std::string printed = hand("wait_idle\nkey 1\n" + shot("first") + "show objects\nset add torus\n" +
                                     shot("added") + "controls\nclick remove\n" + shot("removed"));
    EXPECT_THAT(printed, HasSubstr("control object[1] "));
    EXPECT_FALSE(same(picture("added"), picture("first")));
    EXPECT_TRUE(same(picture("removed"), picture("first")));
}

TEST_F(PreviewEditTest, WhatTheSceneCannotHoldIsToldAndChangesNothing) {
    const std::string before = bytes_of(scene_);
    const std::string printed =
        hand("wait_idle\nshow light\nset light.probe none.exr\nwait_idle\nkey ctrl+s\nwait_idle");
    EXPECT_THAT(printed, HasSubstr("none.exr"));
    EXPECT_EQ(bytes_of(scene_), before);
}

/// What the file has behind a key in the last of its objects.
std::vector<double> numbers_of(const std::string& scene, const std::string& key) {
    std::vector<double> numbers;
    const std::size_t object = scene.rfind("[[object]]"), at = scene.find("\n" + key + " = ", object);
    if (object == std::string::npos || at == std::string::npos) return numbers;
    const std::size_t value = at + key.size() + 4;
    std::string list = scene.substr(value, scene.find('\n', value) - value);
    std::ranges::replace_if(
        list, [](char letter) { return letter == '[' || letter == ']' || letter == ','; }, ' ');
    std::istringstream words(list);
    for (double number = 0; words >> number;) numbers.push_back(number);
    return numbers;
}

// Drags are told by the window's pixels, where the picture is shown at 1:1: half a millimetre of the table each.
TEST_F(PreviewEditTest, ObjectsAreDraggedOverTheirPlaneAndLifted) {
    append_to_scene("\n[[object]]\nshape = \"sphere\"\ntranslate = [-0.05, -0.1, 0.02]\nscale = 0.04\n");
    hand(
        "wait_idle\nkey 1\nwait_idle\nclick 410 405\nwait_idle\ndrag 418 396 518 380 3\nwait_idle\nkey "
        "ctrl+s\nwait_idle");
    std::string saved = bytes_of(scene_);
    EXPECT_THAT(numbers_of(saved, "translate"), ElementsAre(DoubleNear(0.034, 0.002), DoubleNear(-0.099, 0.002), 0.02));
    EXPECT_THAT(numbers_of(saved, "scale"), ElementsAre(0.04));
    // Back by the object itself, and up by the knob above it. It is grabbed 2 cm above its middle and so much nearer to
    // the camera: a pixel is a twentieth less there, which is 4 mm of the way.
    hand(
        "wait_idle\nkey 1\nwait_idle\ndrag 518 380 418 396 3\nwait_idle\ndrag 417 342 416 300 3\nkey "
        "ctrl+s\nwait_idle");
    saved = bytes_of(scene_);
    EXPECT_THAT(numbers_of(saved, "translate"), ElementsAre(DoubleNear(-0.05, 0.005), DoubleNear(-0.1, 0.005),
                                                            testing::AllOf(testing::Gt(0.04), testing::Lt(0.08))));
}

TEST_F(PreviewEditTest, TheRingTurnsAndTheSquareScales) {
    append_to_scene("\n[[object]]\nshape = \"box\"\ntranslate = [-0.05, -0.1, 0.02]\nscale = 0.04\n");
    hand(
        "wait_idle\nkey 1\nwait_idle\nclick 410 405\nwait_idle\ndrag 510 384 600 372 3\nwait_idle\n"
        "drag 348 404 419 450 4\nkey ctrl+s\nwait_idle\n");
    const std::string saved = bytes_of(scene_);
    // Twice as far from the middle; a quarter of the ring, which is seen at a slant.
    EXPECT_THAT(numbers_of(saved, "scale"), ElementsAre(DoubleNear(0.08, 0.008)));
    EXPECT_THAT(numbers_of(saved, "rotate_deg"), ElementsAre(0, 0, DoubleNear(90, 12)));
    EXPECT_THAT(numbers_of(saved, "translate"), ElementsAre(-0.05, -0.1, 0.02));
}

TEST_F(PreviewEditTest, WhatMovesByKeysGetsOneWhereItIsDragged) {
    append_to_scene(
        "\n[[object]]\nshape = \"sphere\"\nkeys = [{frame = 0, translate = [-0.05, -0.1, 0.02], scale = 0.04},\n"
        "        {frame = 11, translate = [-0.05, -0.1, 0.06], scale = 0.04}] # up\n");
    hand(
        "wait_idle\nkey 1\nwait_idle\nclick 410 405\nwait_idle\ndrag 418 396 518 380 3\nwait_idle\nkey "
        "ctrl+s\nwait_idle");
    const std::string first = bytes_of(scene_);
    EXPECT_THAT(first, HasSubstr("# up"));
    EXPECT_THAT(first, HasSubstr("translate = [-0.05, -0.1, 0.06], scale = 0.04}]")) << "the other key is as it was";
    EXPECT_THAT(first, testing::ContainsRegex("frame = 0, translate = .0\\.03[0-9]+, -0\\.09[0-9]*, 0\\.02"));
    // Between its keys, where it stands 5/11 of the way up, it is given one more.
    hand("wait_idle\nkey 1\nframe 5\nwait_idle\ndrag 470 360 520 340 3\nwait_idle\nkey ctrl+s\nwait_idle");
    EXPECT_THAT(bytes_of(scene_),
                testing::ContainsRegex("scale = 0.04}, .frame = 5, translate = .0[-0-9., ]*, 0.0381*8., scale = "
                                       "0.04}, .frame = 11, translate = .-0.05, -0.1, 0.06., scale = 0.04}. # up"));
}

TEST_F(PreviewEditTest, AnApertureDrawnByHandIsWhatRenderReads) {
    append_to_scene(
        "\n[effects]\nglare = {level = \"diffraction\", threshold = 0.1, strength = 2, aperture = {blades = 6}}\n");
    const std::string opened = "wait_idle\nkey 1\nshow effects\nwait_idle\n";
    std::istringstream lines(hand(opened + "controls\n"));
    Region square;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string control, name, at;
        words >> control >> name >> at;
        if (name == "effects.glare.aperture.draw") words >> square.x >> square.y >> square.width >> square.height;
    }
    ASSERT_FALSE(square.empty());
    std::string script = opened + shot("blades");
    for (const auto& [x, y] :
         {std::pair(0.1, 0.45), std::pair(0.9, 0.45), std::pair(0.9, 0.55), std::pair(0.1, 0.55)}) {
        script += "click " + std::to_string(square.x + std::lround(x * square.width)) + " " +
                  std::to_string(square.y + std::lround(y * square.height)) + "\n";
    }
    hand(script + "click effects.glare.aperture.take\nmove 100 300\n" + shot("drawn") + "key ctrl+s\nwait_idle");
    EXPECT_THAT(bytes_of(scene_), testing::ContainsRegex("image = \"table.aperture-[0-9a-f]+.png\""));
    EXPECT_FALSE(same(picture("drawn"), picture("blades")));
    EXPECT_TRUE(same(rendered(0), picture("drawn")));
}

/// Three balls before the camera.
std::string balls_with(const std::string& settings) {
    return "\n[[object]]\nspheres = \"balls.xyz\"\nscale = 0.1\nsphere = {radius = 0.4" + settings + "}\n";
}
constexpr const char* balls_xyz = "3\n\nO 0 -1 0.4\nC 0.5 -1 0.4\nN 0.2 -0.7 0.8\n";

TEST_F(PreviewEditTest, SpheresAreOpaqueFirstAndAsTheyAreAtRest) {
    std::ofstream(shot_ / "balls.xyz") << balls_xyz;
    append_to_scene(balls_with(", opacity = 0.5"));
    const std::string printed =
        hand("wait_idle\nmeasure first\nkey 1\n" + shot("first") + "frame 3\nwait_idle\nframe 0\n" + shot("back"));
    EXPECT_THAT(printed, HasSubstr(", 2 pictures, ")) << "peeled at draft they are as the level has them";
    EXPECT_TRUE(same(rendered(0), picture("first")));
    EXPECT_TRUE(same(picture("back"), picture("first")));
}

TEST_F(PreviewEditTest, SpheresThatAreSeenThroughArePeeledBeforeTheyShadeEachOther) {
    std::ofstream(shot_ / "balls.xyz") << balls_xyz;
    const std::string finer = "wait_idle\nkey l\nwait_idle\nmeasure finer";
    const std::string opaque = bytes_of(scene_) + balls_with("");
    append_to_scene(balls_with(", opacity = 0.5"));
    EXPECT_THAT(hand(finer), testing::ContainsRegex("finer: .*, 3 pictures, "));
    std::ofstream(scene_) << opaque;
    EXPECT_THAT(hand(finer), testing::ContainsRegex("finer: .*, 2 pictures, ")) << "no layers";
}

TEST_F(PreviewEditTest, TheResolutionOfAVirtualCameraIsChosen) {
    scene_ = scratch_ / "virtual.toml";
    std::ofstream(scene_)
        << "[camera]\nwidth = 64\nheight = 32\nkeys = [{frame = 0, eye = [0, -3, 1], target = [0, 0, 0]}]\n"
           "[background]\ncolor = [0.1, 0.2, 0.3]\n[[object]]\nshape = \"torus\"\n";
    hand("wait_idle\nshow lens\nset camera.resolution 512×512\nwait_idle\nkey 1\n" + shot("square") +
         "key ctrl+s\nwait_idle");
    EXPECT_THAT(bytes_of(scene_), HasSubstr("width = 512\nheight = 512\n"));
    EXPECT_TRUE(same(rendered(0), part_of(read_rgb8(scratch_ / "square.png"), {194, 49, 512, 512})));
}

TEST_F(PreviewEditTest, AShiftedClickFocusesOnWhatIsThere) {
    hand("wait_idle\nkey 1\nwait_idle\n" + shot("first") + "click 432 290 shift\n" + shot("ball") +
         "click 600 440 shift\n" + shot("table") + "key ctrl+s\nwait_idle\n");
    EXPECT_FALSE(same(picture("ball"), picture("first")));
    EXPECT_FALSE(same(picture("table"), picture("ball")));
    const std::string saved = bytes_of(scene_);
    EXPECT_THAT(saved, HasSubstr("focus_on = \"point\""));
    // On the table its height is 0.
    EXPECT_THAT(saved, testing::ContainsRegex("point = \\[[-0-9.]+, [-0-9.]+, -?0\\]"));
}

TEST_F(PreviewEditTest, DroppedFilesStandWhereTheyAreLetGo) {
    fs::copy_file(shot_ / "objects.glb", shot_ / "more.glb");
    const std::string printed = hand("wait_idle\nkey 1\nwait_idle\n" + shot("first") + "drop 600 440 " +
                                     (shot_ / "more.glb").string() + "\nwait_idle\nclick 200 560\n" + shot("dropped") +
                                     "drop 500 300 " + (shot_ / "none.glb").string() + "\nkey ctrl+s\nwait_idle");
    EXPECT_FALSE(same(picture("dropped"), picture("first")));
    EXPECT_THAT(printed, HasSubstr("none.glb"));
    const std::string saved = bytes_of(scene_);
    EXPECT_THAT(saved, AllOf(HasSubstr("model = \"more.glb\""), Not(HasSubstr("none.glb"))));
    const std::vector<double> place = numbers_of(saved, "translate");
    ASSERT_EQ(place.size(), 3u);
    EXPECT_GT(place[0], 0.02) << "right of the middle";
    EXPECT_LT(place[1], -0.05) << "and before it";
    EXPECT_EQ(place[2], 0);
}

TEST_F(PreviewEditTest, TheCameraLeavesTheFootageAndComesBack) {
    const std::string before = bytes_of(scene_);
    hand("wait_idle\nkey 1\n" + shot("first") + "key v\n" + shot("there") + "drag 300 200 400 240 2\n" +
         shot("turned") + "scroll 400 300 3\n" + shot("near") + "drag 300 300 350 300 2 right\n" + shot("shifted") +
         "show light\nset light.exposure_ev 1\n" + shot("brighter") + "key ctrl+z\nkey v\n" + shot("back") +
         "key ctrl+s\nwait_idle");
    const std::vector<std::string> views{"first", "there", "turned", "near", "shifted", "brighter"};
    for (std::size_t i = 1; i < views.size(); ++i) EXPECT_FALSE(same(picture(views[i]), picture(views[i - 1])));
    EXPECT_TRUE(same(picture("back"), picture("first")));
    EXPECT_EQ(bytes_of(scene_), before);
}

TEST_F(PreviewEditTest, WhatPassesLeaveAndTheProbeAreShown) {
    append_to_scene("\n[effects]\nbloom = \"auto\"\n");
    const std::string printed =
        hand("wait_idle\nkey 1\n" + shot("first") + "show passes\nclick passes.measure\nwait_idle\ncontrols\n" +
             "set passes.composite on\n" + shot("pass") + "click passes.write\nclick view.composite\n" + shot("back") +
             "show light\nset probe.view lat-long\n" + shot("latlong") + "set probe.view \"three balls\"\n" +
             shot("balls") + "set probe.view picture\n" + shot("last"));
    EXPECT_THAT(printed, HasSubstr("control passes.composite "));
    EXPECT_FALSE(same(picture("pass"), picture("first")));
    EXPECT_TRUE(same(picture("back"), picture("first")));
    EXPECT_FALSE(same(picture("latlong"), picture("first")));
    EXPECT_FALSE(same(picture("balls"), picture("latlong")));
    EXPECT_TRUE(same(picture("last"), picture("first")));
    const fs::path table = shot_ / "table.frame0000.passes.txt";
    EXPECT_THAT(printed, HasSubstr(table.string()));
    EXPECT_THAT(bytes_of(table), AllOf(HasSubstr("matchlight "), HasSubstr("frame 0"), HasSubstr("composite ")));
}

}  // namespace
}  // namespace matchlight::test
