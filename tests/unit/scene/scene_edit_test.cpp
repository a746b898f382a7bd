// Changes of a scene's text: the key that was meant, and not a byte more.
#include "scene/scene_edit.h"

#include <limits>
#include <ostream>

#include <gtest/gtest.h>

#include "core/error.h"
#include "temporary_folder.h"

namespace matchlight {
namespace {

/// With all that an edit is to leave alone: comments, blank lines, alignment, other ways to write a table.
constexpr std::string_view commented = R"(# A table. ö

[footage]
video  = "plate.mp4"   # the take
camera = "camera.yaml"

[light]
probe = "room.exr"
# exposure_ev = 0.5

# The ball.
[[object]]
shape = "sphere" # chrome
translate = [
    0.0, # x
    0.1,
    0.02,
]

[object.material]
roughness = 0.1

[[object]]
model = "ring.glb"
material = {metallic = 1.0, base_color = [1, 0.8, 0.4]} # gold

[effects]
bloom = "auto" # as it comes
glare.strength = 0.3
depth_of_field = {focus_distance_m = 0.6}

[effects.grain]
seed = 3
)";

struct Edited {
    const char* what;
    std::string_view key;
    SceneValue value;
    std::string_view before, after;  // the one place that changes
};

void PrintTo(const Edited& edited, std::ostream* out) {
    *out << edited.key;
}

class OneChange : public testing::TestWithParam<Edited> {};

TEST_P(OneChange, ChangesItsPlaceAndNotAByteMore) {
    for (const bool windows : {false, true}) {
        const auto in_lines = [&](std::string text) {
            for (std::size_t i = text.find('\n'); windows && i != std::string::npos; i = text.find('\n', i + 2)) {
                text.insert(i, "\r");
            }
            return text;
        };
        const std::string original = in_lines(std::string(commented));
        const std::string before = in_lines(std::string(GetParam().before));
        const std::size_t at = original.find(before);
        ASSERT_NE(at, std::string::npos) << before;
        std::string expected = original;
        expected.replace(at, before.size(), in_lines(std::string(GetParam().after)));
        SceneText text("scene.toml", original);
        text.set(GetParam().key, GetParam().value);
        EXPECT_EQ(text.text(), expected);
    }
}

INSTANTIATE_TEST_SUITE_P(
    OfAScene, OneChange,
    testing::Values(
        Edited{"value", "footage.video", "other.mov", R"("plate.mp4")", R"("other.mov")"},
        Edited{"number", "object[0].material.roughness", 0.25, "roughness = 0.1", "roughness = 0.25"},
        Edited{"array_over_lines", "object[0].translate", std::vector<double>{0.1, 0.30000000000000004, -2},
               "[\n    0.0, # x\n    0.1,\n    0.02,\n]", "[0.1, 0.30000000000000004, -2]"},
        Edited{"new_key_of_a_header", "object[0].scale", 2.0, "    0.02,\n]\n", "    0.02,\n]\nscale = 2\n"},
        Edited{"new_key_of_a_nested_header", "object[0].material.metallic", true, "roughness = 0.1\n",
               "roughness = 0.1\nmetallic = true\n"},
        Edited{"value_in_braces", "object[1].material.metallic", 0.5, "metallic = 1.0", "metallic = 0.5"},
        Edited{"new_key_in_braces", "object[1].material.roughness", 0.5, "0.4]}", "0.4], roughness = 0.5}"},
        Edited{"table_for_a_word", "effects.bloom.strength", 0.4, R"("auto")", "{strength = 0.4}"},
        Edited{"two_tables_for_nothing", "effects.dazzle.glare.halo", 1.5, "{focus_distance_m = 0.6}\n",
               "{focus_distance_m = 0.6}\ndazzle = {glare = {halo = 1.5}}\n"},
        Edited{"dotted", "effects.glare.strength", 0.5, "glare.strength = 0.3", "glare.strength = 0.5"},
        Edited{"new_dotted", "effects.glare.aperture.blades", 5, "glare.strength = 0.3\n",
               "glare.strength = 0.3\nglare.aperture = {blades = 5}\n"},
        Edited{"word_for_braces", "effects.depth_of_field", "off", "{focus_distance_m = 0.6}", R"("off")"},
        Edited{"comment_stays", "light.exposure_ev", -1.0, "probe = \"room.exr\"\n",
               "probe = \"room.exr\"\nexposure_ev = -1\n"},
        Edited{"new_section", "surface.z", 0.01, "gold\n\n[effects]", "gold\n\n[surface]\nz = 0.01\n\n[effects]"},
        Edited{"new_section_by_its_order", "tags.family", "tag25h9", "\"camera.yaml\"\n",
               "\"camera.yaml\"\n\n[tags]\nfamily = \"tag25h9\"\n"},
        Edited{"list_of_tables", "object[1].keys", TomlText("[{frame = 0}, {frame = 9}]"), "# gold\n",
               "# gold\nkeys = [{frame = 0}, {frame = 9}]\n"}),
    [](const auto& tested) { return std::string(tested.param.what); });

TEST(SceneEdit, RemovesAKeyOfEveryForm) {
    const auto without = [](std::string_view key, std::string_view gone, std::string_view instead = "") {
        std::string expected(commented);
        expected.replace(expected.find(gone), gone.size(), instead);
        SceneText text("scene.toml", std::string(commented));
        text.remove(key);
        EXPECT_EQ(text.text(), expected) << key;
    };
    without("object[0].shape", "shape = \"sphere\" # chrome\n");
    without("object[1].material.metallic", "metallic = 1.0, ");
    without("object[1].material.base_color", ", base_color = [1, 0.8, 0.4]");
    without("effects.depth_of_field.focus_distance_m", "focus_distance_m = 0.6");
    without("effects.glare", "glare.strength = 0.3\n");
    // An empty table still turns glare on.
    without("effects.glare.strength", "glare.strength = 0.3", "glare = {}");
    without("effects.grain", "\n[effects.grain]\nseed = 3\n");
    without("object[0].material", "[object.material]\nroughness = 0.1\n\n");
    without("surface.z", "");
}

TEST(SceneEdit, RemovesAnObjectWithItsTablesAndItsComment) {
    SceneText text("scene.toml", std::string(commented));
    text.remove("object[0]");
    std::string expected(commented);
    const std::size_t begin = expected.find("# The ball."), end = expected.find("[[object]]\nmodel");
    expected.erase(begin, end - begin);
    EXPECT_EQ(text.text(), expected);
    text.remove("object[0]");
    EXPECT_EQ(text.count("object"), 0U);
    EXPECT_NE(text.text().find("# exposure_ev = 0.5\n\n[effects]\n"), std::string::npos) << text.text();
}

TEST(SceneEdit, AppendsAnObjectBehindTheOthers) {
    SceneText text("scene.toml", std::string(commented));
    text.append("object", {{"shape", "teapot"}, {"translate", std::vector<double>{0, 0, 0.1}}});
    std::string expected(commented);
    expected.insert(expected.find("[effects]"), "[[object]]\nshape = \"teapot\"\ntranslate = [0, 0, 0.1]\n\n");
    EXPECT_EQ(text.text(), expected);
    EXPECT_EQ(text.count("object"), 3U);
}

TEST(SceneEdit, AppendsAndRemovesInListsOfEveryForm) {
    SceneText none("scene.toml", "[camera]\nwidth = 8");
    none.append("object", {{"shape", "cube"}});
    EXPECT_EQ(none.text(), "[camera]\nwidth = 8\n\n[[object]]\nshape = \"cube\"\n");
    SceneText braces("scene.toml", "object = [{shape = \"cube\"}]\n");
    braces.append("object", {{"shape", "torus"}});
    EXPECT_EQ(braces.text(), "object = [{shape = \"cube\"}, {shape = \"torus\"}]\n");
    braces.set("object[0].scale", 2);
    braces.remove("object[1]");
    EXPECT_EQ(braces.text(), "object = [{shape = \"cube\", scale = 2}]\n");
    SceneText lines("scene.toml", "[tags]\nrig = [\n    {id = 0, size = 0.1}, # left\n]\n");
    lines.append("tags.rig", {{"id", 1}, {"size", 0.1}});
    EXPECT_EQ(lines.text(), "[tags]\nrig = [\n    {id = 0, size = 0.1},\n    {id = 1, size = 0.1}, # left\n]\n");
}

TEST(SceneEdit, ReplacesATableOfSeveralLinesByAWord) {
    SceneText text("scene.toml", std::string(commented));
    text.set("effects.grain", "off");
    text.set("effects.glare", "off");
    EXPECT_NE(text.text().find("depth_of_field = {focus_distance_m = 0.6}\ngrain = \"off\"\nglare = \"off\"\n"),
              std::string::npos)
        << text.text();
    EXPECT_EQ(text.text().find("[effects.grain]"), std::string::npos);
}

TEST(SceneEdit, FindsTablesThatAreWrittenUnusually) {
    SceneText implied("scene.toml", "# grain\n[effects.grain]\nseed = 3\n");
    implied.set("effects.bloom", "auto");
    EXPECT_EQ(implied.text(), "[effects]\nbloom = \"auto\"\n\n# grain\n[effects.grain]\nseed = 3\n");
    SceneText list("scene.toml", "[[light]]\nprobe = \"a.exr\"");
    list.set("light.exposure_ev", 1);
    EXPECT_EQ(list.text(), "[[light]]\nprobe = \"a.exr\"\nexposure_ev = 1\n");
    SceneText lights("scene.toml", "[[light]]\ntype = \"directional\"\n[[light]]\nprobe = \"a.exr\"\n");
    lights.set("light.exposure_ev", 1);
    EXPECT_EQ(lights.text(), "[[light]]\ntype = \"directional\"\n[[light]]\nprobe = \"a.exr\"\nexposure_ev = 1\n");
    SceneText root("scene.toml", "effects.bloom = \"off\"\nsurface = {z = 0}\n\n[light]\nprobe = \"a.exr\"\n");
    root.set("effects.glare", "auto");
    root.set("surface.shadow", false);
    EXPECT_EQ(root.text(),
              "effects.bloom = \"off\"\neffects.glare = \"auto\"\nsurface = {z = 0, shadow = false}\n\n[light]\nprobe "
              "= \"a.exr\"\n");
    SceneText marked("scene.toml", "\xEF\xBB\xBF[surface]\n\tz = 0\n");
    marked.set("surface.z", 1);
    marked.set("surface.shadow", true);
    EXPECT_EQ(marked.text(), "\xEF\xBB\xBF[surface]\n\tz = 1\n\tshadow = true\n");
    SceneText wide("scene.toml", "[surface]\n\"\xC3\xB6\\u00f6\" = {a = \"\xE2\x82\xAC\", b = 1, c.d = 2}\n");
    wide.set("surface.z", 0);
    EXPECT_EQ(wide.text(), "[surface]\n\"\xC3\xB6\\u00f6\" = {a = \"\xE2\x82\xAC\", b = 1, c.d = 2}\nz = 0\n");
}

TEST(SceneEdit, RefusesWhatItCannotChangeAlone) {
    // Removing the object would take [effects] with it, which stands between it and its material.
    const std::string odd = "[[object]]\nshape = \"cube\"\n[effects]\n[object.material]\nroughness = 1\n";
    SceneText text("scene.toml", odd);
    try {
        text.remove("object[0]");
        FAIL() << text.text();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "scene.toml:1: 'object[0]' is written in a way that cannot be changed here; change it in a text "
                     "editor");
    }
    EXPECT_EQ(text.text(), odd);
    EXPECT_THROW(text.set("object[3].scale", 1), InputError);
    EXPECT_THROW(text.set("surface", 1), InputError);
    EXPECT_THROW(text.set("surface.z", std::numeric_limits<double>::quiet_NaN()), InputError);
    EXPECT_THROW(text.set("object[0].keys", TomlText("1\n[light]")), InputError);
    EXPECT_EQ(text.text(), odd);
}

TEST(SceneEdit, SaysWhereTheTextIsNoToml) {
    try {
        SceneText("scene.toml", "[light]\nprobe = \n");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).rfind("scene.toml:2: ", 0), 0U) << error.what();
    }
}

class UnsavedScene : public TemporaryFolder {};

TEST_F(UnsavedScene, IsReadRelativeToItsFile) {
    const auto path = write("scene.toml", "[camera]\nwidth = 64\nheight = 48\norbit = {radius = 1}\n");
    write("ball.obj", "v 0 0 0\n");
    SceneText text = SceneText::load(path);
    text.append("object", {{"model", "ball.obj"}});
    text.set("effects.bloom.strength", 0.125);
    Warnings warnings;
    const Scene edited = load_scene(text, warnings);
    EXPECT_EQ(edited.objects.at(0).model, folder_ / "ball.obj");
    EXPECT_EQ(edited.effects.bloom->strength, 0.125);
    EXPECT_TRUE(load_scene(path, warnings).objects.empty());
}

}  // namespace
}  // namespace matchlight
