// Scene files: every setting arrives, and every mistake is answered with file, line and cure.
#include "scene/scene_file.h"

#include <locale>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "scene/color_map.h"
#include "scene/scene_schema.h"
#include "temporary_folder.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const char* const footage_and_tags =
    "[footage]\nvideo = \"clip.mp4\"\ncamera = \"camera.yaml\"\n"        // lines 1 to 3
    "[tags]\nrig = [ {id = 0, size = 0.08}, {id = 1, size = 0.04} ]\n";  // lines 4 and 5

class SceneFile : public TemporaryFolder {
protected:
    void SetUp() override {
        TemporaryFolder::SetUp();
        warnings_.set_quiet(true);
        for (const char* name : {"clip.mp4", "camera.yaml", "room.exr", "objects.glb", "response.json"})
            write(name, "x");
    }

    Scene load(const std::string& text) { return load_scene(write("scene.toml", text), warnings_); }

    /// The line that a bad scene gets, without the folder.
    std::string error_of(const std::string& text) {
        try {
            load(text);
        } catch (const InputError& error) {
            std::string line = error.what();
            const std::string prefix = folder_.string() + "/";
            for (std::size_t at = line.find(prefix); at != std::string::npos; at = line.find(prefix)) {
                line.erase(at, prefix.size());
            }
            EXPECT_EQ(line.find('\n'), std::string::npos);
            return line;
        }
        return "no error";
    }
    std::string error_after(const std::string& text) { return error_of(footage_and_tags + text); }

    Warnings warnings_;
};

TEST_F(SceneFile, DefaultsHoldWhereNothingIsSaid) {
    const Scene scene = load(footage_and_tags);
    EXPECT_EQ(scene.footage.video, folder_ / "clip.mp4");
    EXPECT_EQ(scene.footage.solve, folder_ / "scene.solve.json");
    EXPECT_FALSE(scene.footage.response || scene.footage.fps || scene.footage.color_matrix);
    EXPECT_EQ(scene.tags.family, "tag36h11");
    ASSERT_EQ(scene.tags.rig.size(), 2u);
    EXPECT_EQ(scene.tags.rig[1].id, 1);
    EXPECT_EQ(scene.tags.rig[1].size_m, 0.04);
    EXPECT_FALSE(scene.tags.rig[0].world_from_tag);
    EXPECT_EQ(scene.tags.white_albedo, 0.8);
    EXPECT_EQ(scene.tags.black_albedo, 0.04);
    EXPECT_FALSE(scene.probe);
    EXPECT_TRUE(scene.objects.empty());
    EXPECT_TRUE(scene.surface.present && scene.surface.shadow);
    EXPECT_EQ(scene.surface.z_m, 0);
    EXPECT_EQ(scene.surface.reflection, 0);
    EXPECT_FALSE(scene.reflections || scene.bounce || scene.sphere_edges);
    EXPECT_EQ(scene.transparency, TransparencyMethod::lists);
    EXPECT_EQ(scene.quality, QualityLevel::final_);
    EXPECT_EQ(scene.output.codec, "h264");
    EXPECT_EQ(scene.output.preset, "medium");
    EXPECT_TRUE(scene.output.audio);
    EXPECT_FALSE(scene.output.crf || scene.output.pixel_format);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SceneFile, AResponseIsAFileOrTheWordSolve) {
    const std::string rest =
        "video = \"clip.mp4\"\ncamera = \"camera.yaml\"\n[tags]\nrig = [ {id = 0, size = 0.08} ]\n";
    const Scene solved = load("[footage]\nresponse = \"solve\"\n" + rest);
    EXPECT_TRUE(solved.footage.solve_response);
    EXPECT_FALSE(solved.footage.response);
    const Scene given = load("[footage]\nresponse = \"response.json\"\n" + rest);
    EXPECT_FALSE(given.footage.solve_response);
    EXPECT_TRUE(given.footage.response);
    EXPECT_THROW(load("[footage]\nresponse = \"solved\"\n" + rest), InputError);
}

TEST_F(SceneFile, FootageMayComeWithoutACamera) {
    const Scene scene = load("[footage]\nvideo = \"clip.mp4\"\nreadout = 0.016\n[tags]\nrig = [{id = 0, size = 1}]\n");
    EXPECT_TRUE(scene.footage.camera.empty());
    EXPECT_EQ(scene.footage.readout_s, 0.016);
    EXPECT_FALSE(scene.footage.solve_readout);
    EXPECT_EQ(scene.footage.refine_lens, LensRefinement::automatic);
}

TEST_F(SceneFile, EverySettingArrives) {
    const Scene scene = load(R"(
[footage]
video = "frames/%04d.jpg"
camera = "camera.yaml"
solve = "elsewhere/a.solve.json"
response = "response.json"
refine_lens = "off"
readout = "solve"
fps = 30
color_matrix = "bt601"
color_range = "full"
[tags]
family = "tag25h9"
white_albedo = 0.7
black_albedo = 0.05
rig = [ {id = 3, size = 0.1, x = 1, rotation_deg = 90}, {id = 4, size = 0.1, rotation_deg = [90, 0, 0]}, {id = 5, size = 0.2} ]
[light]
probe = "room.exr"
mapping = "mirrorball"
rotation_deg = 12.5
exposure_ev = -1
place = [0, 0.02, 0.04]
[[object]]
model = "objects.glb"
translate = [1, 2, 3]
rotate_deg = [10, 20, 30]
scale = 2
parent_tag = 4
reflection = "sphere_map"
casts_shadow = false
material = {base_color = [0.1, 0.2, 0.3], metallic = 1, roughness = 0.25, emissive = [4, 5, 6], diffuse = [0.5, 0.4, 0.3], specular = [0.9, 0.8, 0.7]}
[[object]]
shape = "torus"
scale = [1, 2, 3]
name = "ring"
[[object]]
model = "objects.glb"
[surface]
enabled = false
z = 0.5
shadow = false
reflection = 0.04
reflection_roughness = 0.3
[quality]
level = "draft"
reflections = "rays"
bounce = false
sphere_edges = 8
transparency = "weighted_blended"
[output]
codec = "ffv1"
crf = 18
pixel_format = "yuv444p"
preset = "fast"
audio = false
)");
    EXPECT_EQ(scene.footage.video, folder_ / "frames/%04d.jpg");
    EXPECT_EQ(scene.footage.solve, folder_ / "elsewhere/a.solve.json");
    EXPECT_EQ(scene.footage.response, folder_ / "response.json");
    EXPECT_EQ(scene.footage.refine_lens, LensRefinement::off);
    EXPECT_TRUE(scene.footage.solve_readout);
    EXPECT_EQ(scene.footage.fps, 30);
    EXPECT_EQ(scene.footage.color_matrix, "bt601");
    EXPECT_EQ(scene.footage.color_range, "full");
    EXPECT_EQ(scene.tags.family, "tag25h9");
    EXPECT_EQ(scene.tags.white_albedo, 0.7);
    EXPECT_EQ(scene.tags.black_albedo, 0.05);
    ASSERT_EQ(scene.tags.rig.size(), 3u);
    ASSERT_TRUE(scene.tags.rig[0].world_from_tag && scene.tags.rig[1].world_from_tag);
    EXPECT_FALSE(scene.tags.rig[2].world_from_tag);
    // Turned by 90° about z and moved to x = 1, the tag's own x axis points along world y.
    EXPECT_TRUE(
        (*scene.tags.rig[0].world_from_tag * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(1, 1, 0), 1e-12));
    // Turned by 90° about x, its y axis points up.
    EXPECT_TRUE(
        (*scene.tags.rig[1].world_from_tag * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
    ASSERT_TRUE(scene.probe);
    EXPECT_EQ(scene.probe->path, folder_ / "room.exr");
    EXPECT_EQ(scene.probe->mapping, ProbeMapping::mirrorball);
    EXPECT_EQ(scene.probe->placement.rotation_deg, 12.5);
    EXPECT_EQ(scene.probe->placement.exposure_ev, -1);
    EXPECT_EQ(scene.probe->place_m, Eigen::Vector3d(0, 0.02, 0.04));
    ASSERT_EQ(scene.objects.size(), 3u);
    const ObjectSettings& object = scene.objects[0];
    EXPECT_EQ(object.model, folder_ / "objects.glb");
    EXPECT_EQ(object.name, "objects");
    EXPECT_EQ(object.translate_m, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(object.rotate_deg, Eigen::Vector3d(10, 20, 30));
    EXPECT_EQ(object.scale, Eigen::Vector3d(2, 2, 2));
    EXPECT_EQ(object.parent_tag, 4);
    EXPECT_EQ(object.reflection, ReflectionForm::sphere_map);
    EXPECT_FALSE(object.casts_shadow);
    using Color = std::array<double, 3>;
    EXPECT_EQ(object.material.base_color, (Color{0.1, 0.2, 0.3}));
    EXPECT_EQ(object.material.metallic, 1);
    EXPECT_EQ(object.material.roughness, 0.25);
    EXPECT_EQ(object.material.emissive, (Color{4, 5, 6}));
    EXPECT_EQ(object.material.diffuse, (Color{0.5, 0.4, 0.3}));
    EXPECT_EQ(object.material.specular, (Color{0.9, 0.8, 0.7}));
    EXPECT_EQ(scene.objects[1].shape, "torus");
    EXPECT_EQ(scene.objects[1].scale, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(scene.objects[1].name, "ring");
    EXPECT_EQ(scene.objects[2].name, "objects 2");
    EXPECT_FALSE(scene.surface.present || scene.surface.shadow);
    EXPECT_EQ(scene.surface.z_m, 0.5);
    EXPECT_EQ(scene.surface.reflection, 0.04);
    EXPECT_EQ(scene.surface.reflection_roughness, 0.3);
    EXPECT_EQ(scene.quality, QualityLevel::draft);
    EXPECT_EQ(scene.reflections, ReflectionLevel::rays);
    EXPECT_EQ(scene.bounce, false);
    EXPECT_EQ(scene.sphere_edges, 8);
    EXPECT_EQ(scene.transparency, TransparencyMethod::weighted_blended);
    EXPECT_EQ(scene.output.codec, "ffv1");
    EXPECT_EQ(scene.output.crf, 18);
    EXPECT_EQ(scene.output.pixel_format, "yuv444p");
    EXPECT_EQ(scene.output.preset, "fast");
    EXPECT_FALSE(scene.output.audio);

    // What is recorded of the scene is a scene that records the same.
    EXPECT_EQ(load(scene.effective_toml).effective_toml, scene.effective_toml);
}

TEST(SampleScene, Loads) {
    Warnings warnings;
    warnings.set_quiet(true);
    const Scene scene = load_scene(std::string(MATCHLIGHT_SOURCE_DIR) + "/samples/table/table.toml", warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(scene.tags.rig.size(), 4u);
    EXPECT_EQ(scene.objects.size(), 1u);
    EXPECT_TRUE(scene.probe && scene.probe->place_m);
}

TEST_F(SceneFile, EffectiveSettingsHoldTheDefaults) {
    const std::string effective = load(std::string(footage_and_tags) + "[[object]]\nshape = \"box\"\n").effective_toml;
    EXPECT_THAT(effective, HasSubstr("family = \"tag36h11\""));
    EXPECT_THAT(effective, HasSubstr("white_albedo = 0.8"));
    EXPECT_THAT(effective, HasSubstr("rig = [{id = 0, size = 0.08}, {id = 1, size = 0.04}]"));
    EXPECT_THAT(effective, HasSubstr("scale = [1, 1, 1]"));
    EXPECT_THAT(effective, HasSubstr("depth_of_field = \"off\""));
    EXPECT_THAT(effective, HasSubstr("level = \"final\""));
    EXPECT_EQ(load(effective).effective_toml, effective);
}

TEST_F(SceneFile, UnknownKeysNameTheNearest) {
    EXPECT_EQ(error_after("[light]\nprobe = \"room.exr\"\nexpsure_ev = 1\n"),
              "scene.toml:8: unknown key 'expsure_ev' in [light]; did you mean 'exposure_ev'?");
    EXPECT_EQ(error_after("[lights]\nprobe = \"room.exr\"\n"),
              "scene.toml:6: unknown section 'lights'; did you mean 'light'?");
    EXPECT_EQ(error_after("[[object]]\nshape = \"box\"\nmaterial = {rougness = 1}\n"),
              "scene.toml:8: unknown key 'rougness' in [object.material]; did you mean 'roughness'?");
    EXPECT_EQ(error_after("[quality]\ncrf = 1\n"),
              "scene.toml:7: unknown key 'crf' in [quality]; it belongs in [output]");
    EXPECT_THAT(
        error_of("[footage]\nvideo = \"clip.mp4\"\ncamera = \"camera.yaml\"\n[tags]\nrig = [{id = 0, sizw = 1}]\n"),
        HasSubstr("scene.toml:5: unknown key 'sizw' in [tags.rig]; did you mean 'size'?"));
    EXPECT_THAT(error_after("[output]\n" + std::string(100000, 'a') + " = 1\n"), HasSubstr("unknown key"));
}

TEST_F(SceneFile, SyntaxErrorsNameTheLine) {
    EXPECT_THAT(error_after("[light\n"), HasSubstr("scene.toml:6: "));
    EXPECT_THAT(error_after("[quality]\nlevel = \"final\"\nlevel = \"draft\"\n"), HasSubstr("scene.toml:8: "));
    EXPECT_THAT(error_after("[quality]\nlevel = \"\xff\"\n"), HasSubstr("scene.toml:7: "));
    EXPECT_THAT(error_after("[x]\na = " + std::string(100000, '[')),
                HasSubstr("scene.toml:7: "));  // does not recurse on
}

TEST_F(SceneFile, WrongTypesAndRangesNameTheLine) {
    const std::vector<std::pair<std::string, std::string>> rows = {
        {"[quality]\nlevel = 3", "scene.toml:7: 'level' in [quality] is 3, not draft, preview, final, reference"},
        {"[quality]\nlevel = \"finl\"", "did you mean 'final'?"},
        {"[surface]\nz = \"high\"", "scene.toml:7: 'z' in [surface] is \"high\", not number"},
        {"[surface]\nz = nan", "scene.toml:7: 'z' in [surface] is not finite"},
        {"[surface]\nz = -inf", "scene.toml:7: 'z' in [surface] is not finite"},
        {"[surface]\nreflection = 1.1", "scene.toml:7: 'reflection' in [surface] is 1.1, outside its range"},
        {"[surface]\nreflection_roughness = -0.1", "is -0.1, outside its range (number, from 0 to 1)"},
        {"[surface]\nreflection = true", "scene.toml:7: 'reflection' in [surface] is true, not number"},
        {"[quality]\nreflections = \"ray\"", "did you mean 'rays'?"},
        {"[quality]\nsphere_edges = 17", "outside its range (whole number, from 0 to 16)"},
        {"[quality]\ntransparency = \"moment\"", "did you mean 'moments'?"},
        {"[quality]\nbounce = 0", "scene.toml:7: 'bounce' in [quality] is 0, not true or false"},
        {"[surface]\nenabled = 1", "scene.toml:7: 'enabled' in [surface] is 1, not true or false"},
        {"[surface]\nz = 2000-01-01", "is a date or time, not number"},
        {"[output]\ncrf = 52", "scene.toml:7: 'crf' in [output] is 52, outside its range (whole number, from 0 to 51)"},
        {"[output]\ncrf = 1.5", "not whole number"},
        {"[output]\npixel_format = \"\"", "is empty"},
        {"[object]\nshape = \"box\"", "[object] is a list: write [[object]]"},
        {"[[object]]\nshape = \"box\"\nscale = 0", "scene.toml:8: 'scale' in [object] is 0, outside its range"},
        {"[[object]]\nshape = \"box\"\nscale = [1, 0, 1]", "scene.toml:8: 'scale' in [object] is 0, outside its range"},
        {"[[object]]\nshape = \"box\"\nscale = [1, 1]", "not number or [x, y, z]"},
        {"[[object]]\nshape = \"box\"\ntranslate = [1, 1, nan]", "is not finite"},
        {"[[object]]\nshape = \"box\"\ntranslate = [1, 1, \"2\"]", "not [x, y, z]"},
        {"[[object]]\nshape = \"bax\"", "did you mean 'box'?"},
        {"[[object]]\nshape = \"box\"\nmaterial = 1", "holds tables of settings"},
        {"[[object]]\nshape = \"box\"\nmaterial = {metallic = 2}", "outside its range (number, from 0 to 1)"},
        {"[[object]]\nshape = \"box\"\nmaterial = {base_color = [0, 0, -1]}", "outside its range"},
        {"[[object]]\nshape = \"box\"\nmodel = \"objects.glb\"",
         "scene.toml:6: [[object]] 1 has more than one of model, shape and spheres"},
        {"[[object]]\nname = \"a\"", "has none of model, shape and spheres"},
        {"[[object]]\nshape = \"box\"\nparent_tag = 7", "scene.toml:8: the rig has no tag 7 to be a parent"},
        {"[light]\nexposure_ev = 1", "scene.toml:6: 'probe' is missing in [light]"},
    };
    for (const auto& [text, expected] : rows) EXPECT_THAT(error_after(text + "\n"), HasSubstr(expected)) << text;
    EXPECT_THAT(error_of(std::string("surface = 3\n") + footage_and_tags),
                HasSubstr("[surface] is a table of settings"));
    EXPECT_THAT(error_of(std::string("object = [1]\n") + footage_and_tags),
                HasSubstr("[[object]] is a table of settings"));
}

TEST_F(SceneFile, BadRigsAreRefused) {
    const auto with_rig = [&](const std::string& rig) {
        return error_of("[footage]\nvideo = \"clip.mp4\"\ncamera = \"camera.yaml\"\n[tags]\n" + rig + "\n");
    };
    EXPECT_THAT(with_rig("rig = []"), HasSubstr("scene.toml:5: 'rig' in [tags] is a list of at least one entry"));
    EXPECT_THAT(with_rig(""), HasSubstr("'rig' is missing in [tags]"));
    EXPECT_THAT(with_rig("rig = [{id = 0, size = 0}]"),
                HasSubstr("scene.toml:5: 'size' in [tags.rig] is 0, outside its range"));
    EXPECT_THAT(with_rig("rig = [{id = 0, size = -0.1}]"), HasSubstr("outside its range"));
    EXPECT_THAT(with_rig("rig = [{id = 0, size = nan}]"), HasSubstr("not finite"));
    EXPECT_THAT(with_rig("rig = [{id = 0}]"), HasSubstr("'size' is missing"));
    EXPECT_THAT(with_rig("rig = [{id = -1, size = 1}]"), HasSubstr("outside its range"));
    EXPECT_THAT(with_rig("rig = [{id = 2, size = 1},\n{id = 2, size = 1}]"),
                HasSubstr("scene.toml:6: the rig has the tag 2 twice"));
    EXPECT_THAT(with_rig("rig = [{id = 587, size = 1}]"), HasSubstr("there is no tag 587 in tag36h11 (0 to 586)"));
    EXPECT_THAT(error_of("[footage]\nvideo = \"clip.mp4\"\ncamera = \"camera.yaml\"\n"), HasSubstr("'rig' is missing"));
}

TEST_F(SceneFile, MissingFilesAreNamed) {
    EXPECT_EQ(error_of("[footage]\nvideo = \"no.mp4\"\ncamera = \"camera.yaml\"\n"),
              "scene.toml:2: 'video' in [footage]: there is no file 'no.mp4'");
    EXPECT_THAT(error_of("[footage]\nvideo = \"clip.mp4\"\ncamera = \"no.yaml\"\n"),
                HasSubstr("scene.toml:3: 'camera' in [footage]: there is no file 'no.yaml'"));
    EXPECT_THAT(error_of("[footage]\nvideo = \"100%.mp4\"\ncamera = \"camera.yaml\"\n"), HasSubstr("there is no file"));
    EXPECT_THAT(error_of("[footage]\ncamera = \"camera.yaml\"\n"), HasSubstr("'video' is missing in [footage]"));
    EXPECT_THAT(error_after("[light]\nprobe = \"no.exr\"\n"),
                HasSubstr("'probe' in [light]: there is no file 'no.exr'"));
    EXPECT_THAT(error_after("[[object]]\nmodel = \"no.glb\"\n"),
                HasSubstr("scene.toml:7: 'model' in [object]: there is no file"));
    EXPECT_THAT(error_after("[[object]]\nmodel = \".\"\n"), HasSubstr("is not a regular file"));
    EXPECT_THAT(error_after("[[object]]\nmodel = \"a\\u0000b\"\n"), HasSubstr("zero byte"));
    EXPECT_THROW(load_scene(folder_ / "none.toml", warnings_), InputError);
}

TEST_F(SceneFile, AnalyticLightsBesideAProbeOrInsteadOfIt) {
    const std::string probe = "[[light]]\nprobe = \"room.exr\"\n";
    EXPECT_EQ(load(footage_and_tags + probe).probe->path, folder_ / "room.exr");
    const std::string lamps =
        "[[light]]\ntype = \"point\"\nposition = [0, 0, 1]\n"
        "[[light]]\ntype = \"spot\"\nposition = [1, 0, 1]\ndirection = [0, 1, -1]\nouter_cone_deg = 20\nrange = 3\n"
        "[[light]]\ntype = \"directional\"\nintensity = 3\nangle_deg = 0.5\nin_footage = true\n";
    const Scene both = load(footage_and_tags + lamps + probe);
    EXPECT_EQ(both.probe->path, folder_ / "room.exr");
    ASSERT_EQ(both.lamps.size(), 3U);
    EXPECT_EQ(both.lamps[0], (LampSettings{.position_m = {0, 0, 1}, .in_footage = false}));
    EXPECT_EQ(both.lamps[1], (LampSettings{.type = LampType::spot,
                                           .position_m = {1, 0, 1},
                                           .direction = {0, 1, -1},
                                           .outer_cone_deg = 20,
                                           .range_m = 3,
                                           .in_footage = false}));
    EXPECT_EQ(both.lamps[2].type, LampType::directional);
    EXPECT_TRUE(*both.lamps[2].in_footage);
    EXPECT_FALSE(lit_by_lamps_alone(both));
    const Scene alone = load(footage_and_tags + lamps);
    EXPECT_FALSE(alone.probe);
    EXPECT_TRUE(*alone.lamps[0].in_footage) << "what else would the footage be lit by";
    EXPECT_TRUE(lit_by_lamps_alone(alone));
    EXPECT_TRUE(warnings_.empty());
    // What was in force is a scene file, too.
    EXPECT_EQ(load(both.effective_toml).lamps, both.lamps);
}

TEST_F(SceneFile, AnalyticLightsThatMakeNoSenseAreRefused) {
    const auto refusal = [&](const std::string& keys) { return error_after("[[light]]\n" + keys); };
    EXPECT_THAT(refusal("position = [0, 0, 1]\n"), HasSubstr("'type' is missing in [light]"));
    EXPECT_THAT(refusal("type = \"lamp\"\n"), HasSubstr("scene.toml:7: 'type' in [light]"));
    EXPECT_THAT(refusal("type = \"point\"\n"), HasSubstr("'position' is missing in [light]"));
    EXPECT_THAT(refusal("type = \"directional\"\nposition = [0, 0, 1]\n"),
                HasSubstr("'position' in [light] is of no use to a directional light"));
    EXPECT_THAT(refusal("type = \"directional\"\ndirection = [0, 0, 0]\n"), HasSubstr("has no direction"));
    EXPECT_THAT(refusal("type = \"spot\"\nposition = [0, 0, 1]\ninner_cone_deg = 50\n"),
                HasSubstr("'inner_cone_deg' in [light] is 50, more than 'outer_cone_deg', 45"));
    EXPECT_THAT(refusal("type = \"point\"\nposition = [0, 0, 1]\nintensity = -1\n"), HasSubstr("'intensity'"));
    EXPECT_THAT(refusal("type = \"point\"\nposition = [0, 0, nan]\n"), HasSubstr("not finite"));
    EXPECT_THAT(refusal("type = \"point\"\nradios = 1\n"), HasSubstr("did you mean 'radius'?"));
    EXPECT_THAT(error_after("[light]\ntype = \"point\"\n"), HasSubstr("[[light]] for an analytic light"));
    EXPECT_THAT(error_after("[light]\nintensity = 1\n"), HasSubstr("an entry of [[light]] that has a type"));
    std::string many;
    for (int i = 0; i < 33; ++i) many += "[[light]]\ntype = \"directional\"\n";
    EXPECT_THAT(error_after(many), HasSubstr("the scene has 33 analytic lights, and 32 are the most"));
    const std::string probe = "[[light]]\nprobe = \"room.exr\"\n";
    EXPECT_THAT(error_after(probe + probe), HasSubstr("a scene has one probe"));
}

TEST_F(SceneFile, SpheresAndWhatTheirColumnsBecome) {
    write("atoms in water.xyz", "0\n\n");
    const std::string spheres = "[[object]]\nspheres = \"atoms in water.xyz\"\nscale = 1e-3\n";
    const Scene plain = load(footage_and_tags + spheres);
    EXPECT_EQ(plain.objects[0].spheres, folder_ / "atoms in water.xyz");
    EXPECT_EQ(plain.objects[0].name, "atoms in water");
    EXPECT_FALSE(plain.objects[0].sphere.radius);
    EXPECT_EQ(plain.objects[0].sphere.radius_scale, 1);
    const Scene mapped = load(footage_and_tags + spheres +
                              "[object.sphere]\nradius = 0.5\nradius_scale = 2\ncolor_column = \"speed\"\n"
                              "color_map = \"magma\"\ncolor_range = [-1, 4]\nopacity = 0.25\n"
                              "opacity_column = \"age\"\nup = \"y\"\nframe = 3\n");
    const SphereSettings& sphere = mapped.objects[0].sphere;
    EXPECT_EQ(sphere.radius, 0.5);
    EXPECT_EQ(sphere.radius_scale, 2);
    EXPECT_EQ(sphere.color_column, "speed");
    EXPECT_EQ(color_map_names().at(sphere.color_map), "magma");
    EXPECT_EQ(sphere.color_range, (std::array<double, 2>{-1, 4}));
    EXPECT_EQ(sphere.opacity, 0.25);
    EXPECT_EQ(sphere.opacity_column, "age");
    EXPECT_EQ(sphere.up, SphereAxes::y);
    EXPECT_EQ(sphere.frame, 3);
}

TEST_F(SceneFile, SpheresThatCannotBe) {
    write("a.xyz", "0\n\n");
    const std::string spheres = "[[object]]\nspheres = \"a.xyz\"\n";
    EXPECT_THAT(error_after("[[object]]\nspheres = \"no.xyz\"\n"), HasSubstr("scene.toml:7: 'spheres' in [object]"));
    EXPECT_THAT(error_after(spheres + "shape = \"box\"\n"), HasSubstr("more than one of model, shape and spheres"));
    EXPECT_THAT(error_after(spheres + "scale = [1, 2, 1]\n"), HasSubstr("'scale' of [[object]] 1 differs"));
    EXPECT_THAT(error_after(spheres + "keys = [{frame = 0, scale = [1, 1, 2]}]\n"), HasSubstr("spheres stay spheres"));
    EXPECT_THAT(error_after(spheres + "sphere = {radius = 0}\n"), HasSubstr("scene.toml:8: 'radius'"));
    EXPECT_THAT(error_after(spheres + "sphere = {radius = nan}\n"), HasSubstr("not finite"));
    EXPECT_THAT(error_after(spheres + "sphere = {color_range = [2, 1]}\n"), HasSubstr("does not ascend"));
    EXPECT_THAT(error_after(spheres + "sphere = {color_range = [2]}\n"), HasSubstr("not [from, to]"));
    EXPECT_THAT(error_after(spheres + "sphere = {color_map = \"viridi\"}\n"), HasSubstr("did you mean 'viridis'?"));
    EXPECT_THAT(error_after("[[object]]\nshape = \"box\"\nsphere = {radius = 1}\n"), HasSubstr("without spheres"));
}

TEST_F(SceneFile, EffectsThatAreOffOrUnknown) {
    load(std::string(footage_and_tags) + "[effects]\nbloom = \"off\"\nmotion_blur = false\ngrain = false\n");
    EXPECT_TRUE(warnings_.empty());
    EXPECT_THAT(error_after("[effects]\nblom = \"off\"\n"), HasSubstr("did you mean 'bloom'?"));
}

TEST_F(SceneFile, AnyNameAPathCanHaveIsRead) {
    for (const char* name : {"a b.glb", "größe 模型.glb", "-rf.glb", "100%.glb"}) {
        write(name, "x");
        EXPECT_EQ(load(std::string(footage_and_tags) + "[[object]]\nmodel = \"" + name + "\"\n").objects[0].model,
                  folder_ / name);
    }
    const fs::path absolute = write("elsewhere/clip.mp4", "x");
    EXPECT_EQ(load("[footage]\nvideo = \"" + absolute.string() +
                   "\"\ncamera = \"camera.yaml\"\n[tags]\nrig = [{id = 0, size = 1}]\n")
                  .footage.video,
              absolute);
}

TEST_F(SceneFile, CommaDecimalLocalesChangeNothing) {
    struct CommaDecimals : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaDecimals));
    std::string effective;
    double size_m = 0;
    double z_m = 0;
    try {
        const Scene scene = load(std::string(footage_and_tags) + "[surface]\nz = 1234.5\n");
        effective = scene.effective_toml;
        size_m = scene.tags.rig[0].size_m;
        z_m = scene.surface.z_m;
    } catch (const InputError& error) {
        ADD_FAILURE() << error.what();
    }
    std::locale::global(before);
    EXPECT_EQ(size_m, 0.08);
    EXPECT_EQ(z_m, 1234.5);
    EXPECT_THAT(effective, HasSubstr("z = 1234.5"));
    EXPECT_THAT(effective, HasSubstr("size = 0.08"));
}

TEST(SceneSchema, IsConsistent) {
    for (const Setting& setting : scene_settings()) {
        const SceneSection* section = find_section(setting.section);
        ASSERT_NE(section, nullptr) << setting.section;
        EXPECT_EQ(find_setting(setting.section, setting.key), &setting) << setting.key << " is listed twice";
        EXPECT_FALSE(setting.help.empty()) << setting.key;
        const SettingKind kind = setting.domain.kind;
        const bool nested =
            kind == SettingKind::section || kind == SettingKind::sections || kind == SettingKind::effect;
        // An effect that is on by itself has to be turned off.
        const bool turns_off = kind == SettingKind::effect && setting.fallback != "\"off\"";
        const bool holds_value = !nested && kind != SettingKind::left_out && kind != SettingKind::not_built;
        EXPECT_EQ(setting.set != nullptr, holds_value || turns_off) << setting.key;
        // A file may have words that stand in its place.
        if (kind != SettingKind::input_file) {
            const bool has_words = kind == SettingKind::choice || kind == SettingKind::measure;
            EXPECT_EQ(!setting.domain.choices.empty(), has_words) << setting.key;
        }
        if (nested) {
            EXPECT_NE(find_section(std::string(setting.section) + "." + std::string(setting.key)), nullptr)
                << setting.key;
        }
    }
}

TEST(SceneSchema, NearestWordCountsEdits) {
    const std::vector<std::string_view> known = {"probe", "mapping", "exposure_ev"};
    EXPECT_EQ(nearest_word("prboe", known), "probe");
    EXPECT_EQ(nearest_word("map", known), "mapping");
    EXPECT_EQ(nearest_word("expsure_ev", known), "exposure_ev");
    EXPECT_EQ(nearest_word("", known), "probe");
}

TEST(SceneSchema, TextListsEverySetting) {
    const std::string text = scene_schema_text();
    for (const Setting& setting : scene_settings()) {
        EXPECT_THAT(text, HasSubstr("| `" + std::string(setting.key) + "` |"));
    }
    EXPECT_THAT(text, HasSubstr("| `crf` | whole number, from 0 to 51 |"));
}

TEST_F(SceneFile, FocusIsOnThingsThatAreThere) {
    const std::string objects =
        "[[object]]\nshape = \"cone\"\n[[object]]\nshape = \"teapot\"\nfocus = 0.5\n"  // lines 6 to 10
        "[[object]]\nshape = \"teapot\"\nfocus = \"sharp\"\n[effects]\n";              // lines 11 to 14
    const auto with = [&](const std::string& settings) {
        return footage_and_tags + objects + "depth_of_field = {" + settings + "}\n";
    };
    const Scene scene = load(with("focus_on = \"object\", object = \"teapot 2\""));
    EXPECT_EQ(scene.effects.depth_of_field->focus_object, "teapot 2");
    EXPECT_FALSE(scene.objects[0].focus);
    EXPECT_EQ(scene.objects[1].focus->distance_m, 0.5);
    ASSERT_TRUE(scene.objects[2].focus);
    EXPECT_FALSE(scene.objects[2].focus->distance_m);
    EXPECT_EQ(error_of(with("focus_on = \"object\", object = \"teepot\"")),
              "scene.toml:15: 'object' in [effects.depth_of_field]: the scene has no object 'teepot'; did you mean "
              "'teapot'?");
    EXPECT_EQ(error_of(with("focus_on = \"object\"")),
              "scene.toml:15: 'focus_on' in [effects.depth_of_field] is \"object\" without object; give object");
    EXPECT_EQ(error_of(with("focus_on = \"point\"")),
              "scene.toml:15: 'focus_on' in [effects.depth_of_field] is \"point\" without point; give point");
    EXPECT_EQ(error_of(with("point = [0, 0, 1]")),
              "scene.toml:15: 'point' in [effects.depth_of_field] does nothing without focus_on; give focus_on = "
              "\"point\"");
    EXPECT_THAT(error_of(with("focus_on = \"centre\"")), HasSubstr("distance, middle, point, object"));
    EXPECT_THAT(error_after("[[object]]\nshape = \"cone\"\nfocus = 0\n"), HasSubstr("scene.toml:8"));
    EXPECT_THAT(error_after("[[object]]\nshape = \"cone\"\nfocus = \"sharpest\"\n"), HasSubstr("did you mean 'sharp'"));
}

}  // namespace
}  // namespace matchlight
