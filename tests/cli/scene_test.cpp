// Scene files and models that are wrong, as a user meets it: one line, and no output.
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

using testing::HasSubstr;

/// A triangle of 0.05 m on the table as glTF; `json_end` goes on after its primitive, accessors and views.
struct SmallGltf {
    std::string attributes = R"("POSITION":0)";
    std::string nodes = R"([{"mesh":0}])";
    std::string count = "3";
    std::string extra;  // ,"key":value
    std::string buffer_uri = "m.bin";

    std::string text() const {
        return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
               R"(,"meshes":[{"primitives":[{"attributes":{)" + attributes + R"(},"material":0}]}],)" +
               R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)" +
               R"("images":[{"uri":"none.png"}],"bufferViews":[{"buffer":0,"byteLength":36}],)" +
               R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + count + extra +
               R"(}],"buffers":[{"byteLength":36,"uri":")" + buffer_uri + R"("}]})";
    }
    static std::string binary(float last_y = 0.05f) {
        const float positions[] = {0, 0.01f, 0, 0.05f, 0.01f, 0, 0, last_y, 0};
        return {reinterpret_cast<const char*>(positions), sizeof positions};
    }
};

class SceneCommand : public CommandTest {
protected:
    static void SetUpTestSuite() {
        const ScratchFolder scratch;
        const auto folder = scratch.copy_sample("table");
        ASSERT_TRUE(succeeded(run_matchlight({"track", (folder / "table.toml").string(), "-q"})));
        solve_ = bytes_of(folder / "table.solve.json");
    }
    void SetUp() override {
        folder_ = scratch_.copy_sample("table");
        write("scene.solve.json", solve_);
        write("m.bin", SmallGltf::binary());
    }

    void write(const std::filesystem::path& name, const std::string& bytes) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
    }
    /// The sample's scene with other objects.
    static std::string scene_with(const std::string& objects) {
        return "[footage]\nvideo = \"plate.mp4\"\ncamera = \"camera.yaml\"\n"
               "[tags]\nrig = [{id = 0, size = 0.08}, {id = 1, size = 0.08}, {id = 2, size = 0.08}, {id = 3, size = "
               "0.08}]\n"
               "[light]\nprobe = \"probe.exr\"\n" +
               objects;
    }
    RunResult render_scene(const std::string& text, const RunOptions& options = {}) const {
        write("scene.toml", text);
        return run_matchlight({"render", (folder_ / "scene.toml").string(), "-o", (folder_ / "out.mp4").string(),
                               "--frames", "0-0", "--overwrite"},
                              options);
    }
    RunResult render_model(const std::string& name, const std::string& bytes) const {
        write(name, bytes);
        return render_scene(scene_with("[[object]]\nmodel = \"" + name + "\"\n"));
    }
    testing::AssertionResult refused(const RunResult& result, const std::vector<std::string>& words) const {
        if (auto named = failed_naming(result, words); !named) return named;
        return nothing_left_of(folder_ / "out.mp4");
    }

    static std::string solve_;
    std::filesystem::path folder_;
};
std::string SceneCommand::solve_;

TEST_F(SceneCommand, WrongKeysAndValuesNameTheLine) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> rows = {
        {"[light]\nprobe = \"probe.exr\"\nexpsure_ev = 1\n",
         {"scene.toml:", "expsure_ev", "did you mean 'exposure_ev'?"}},
        {scene_with("[[object]]\nshape = \"box\"\nscale = 0\n"), {"scene.toml:10", "scale"}},
        {scene_with("[[object]]\nshape = \"bax\"\n"), {"scene.toml:9", "did you mean 'box'?"}},
        {scene_with("[[object]]\nmodel = \"none.glb\"\n"), {"scene.toml:9", "none.glb", "'model'"}},
        {scene_with("[surface]\nz = nan\n"), {"scene.toml:9", "not finite"}},
        {scene_with("[[object]]\nspheres = \"atoms.xyz\"\n"), {"scene.toml:9", "spheres", "there is no file"}},
        {scene_with("[camera]\nwidth = 800\n"), {"scene.toml:8", "leave one of them out"}},
        {"[tags]\nrig = [{id = 0, size = 0.08}]\n", {"neither footage nor a camera"}},
        {"[footage]\nvideo = \"plate.mp4\"\ncamera = \"none.yaml\"\n[tags]\nrig = [{id = 0, size = 1}]\n",
         {"scene.toml:3", "none.yaml", "'camera'"}},
        {"[footage]\nvideo = \"plate.mp4\"\ncamera = \"camera.yaml\"\n[tags]\nrig = []\n", {"scene.toml:5", "rig"}},
        {"[footage]\nvideo = \"plate.mp4\"\ncamera = \"camera.yaml\"\n[tags]\nrig = [{id = 0, size = 0}]\n",
         {"scene.toml:5", "size"}},
        {"[footage]\nvideo = \"plate.mp4\"\ncamera = \"camera.yaml\"\n[tags]\nrig = [{id = 0, size = 1}, {id = 0, size "
         "= 1}]\n",
         {"scene.toml:5", "tag 0 twice"}},
        {"[[light]]\ntype = \"point\"\n" + scene_with("").substr(0, scene_with("").find("[light]")),
         {"scene.toml:1", "'position' is missing in [light]"}},
        {"not toml at all", {"scene.toml:1"}},
    };
    for (const auto& [text, words] : rows) {
        EXPECT_TRUE(refused(render_scene(text), words)) << text;
    }
    write("scene.toml", rows.front().first);
    EXPECT_TRUE(failed_naming(run_matchlight({"track", (folder_ / "scene.toml").string()}), rows.front().second));
}

TEST_F(SceneCommand, ModelsThatLeaveTheirFolderAreRefused) {
    write("in/m.bin", SmallGltf::binary());
    std::filesystem::create_symlink(folder_ / "m.bin", folder_ / "in" / "link.bin");
    for (const std::string uri : {"../m.bin", "%2e%2e/m.bin", "/etc/passwd", "file:///etc/passwd", "link.bin"}) {
        SmallGltf gltf;
        gltf.buffer_uri = uri;
        EXPECT_TRUE(refused(render_model("in/m.gltf", gltf.text()), {"in/m.gltf", "it names the file"})) << uri;
    }
}

TEST_F(SceneCommand, ModelsThatLieAreRefused) {
    const auto changed = [](auto change) {
        SmallGltf gltf;
        change(gltf);
        return gltf.text();
    };
    const std::vector<std::pair<std::string, std::vector<std::string>>> gltfs = {
        {changed([](SmallGltf& g) { g.count = "4"; }), {"accessors[0]"}},
        {changed([](SmallGltf& g) { g.count = "1000000000"; }), {"accessors[0].count"}},
        {changed([](SmallGltf& g) { g.attributes = R"("POSITION":7)"; }), {"there are 1 accessors"}},
        {changed([](SmallGltf& g) {
             g.extra =
                 R"(,"sparse":{"count":1,"indices":{"bufferView":0,"byteOffset":12,"componentType":5125},"values":{"bufferView":0}})";
         }),
         {"accessors[0].sparse", "index"}},
        {changed([](SmallGltf& g) { g.nodes = R"([{"mesh":0,"children":[1]},{"children":[2]},{"children":[1]}])"; }),
         {"two parents"}},
        {changed([](SmallGltf& g) { g.nodes = R"([{"mesh":0},{"children":[2]},{"children":[1]}])"; }), {"cycle"}},
        {std::string(100000, '['), {"nests deeper"}},
        {changed([](SmallGltf& g) { g.buffer_uri = "none.bin"; }), {"none.bin"}},
        {R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]})",
         {"KHR_draco_mesh_compression"}},
    };
    for (const auto& [text, words] : gltfs)
        EXPECT_TRUE(refused(render_model("m.gltf", text), words)) << text.substr(0, 300);

    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    EXPECT_TRUE(refused(render_model("m.obj", vertices + "f 0 1 2\n"), {"m.obj:4", "index 0"}));
    EXPECT_TRUE(refused(render_model("m.obj", vertices + "f 1 2 4\n"), {"m.obj:4", "index 4 is beyond the 3"}));
    const std::string ply = "ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nend_header\n0\n";
    EXPECT_TRUE(refused(render_model("m.ply", ply), {"m.ply", "1000000000"}));
    EXPECT_TRUE(refused(render_model("m.stl", std::string(80, '\0') + "\x01\xca\x9a\x3b"), {"m.stl", "triangles"}));
    EXPECT_TRUE(refused(render_model("m.fbx", "x"), {"m.fbx", "not supported"}));
    EXPECT_TRUE(refused(render_model("m.glb", ""), {"m.glb"}));
}

TEST_F(SceneCommand, WhatCanBeLeftOutIsCounted) {
    // A texture that is not there; a second triangle that is not finite; a third without area; no normals, no UVs.
    SmallGltf gltf;
    write("texture.gltf", gltf.text());
    write("bad.obj", "v 0 0.01 0\nv 0.05 0.01 0\nv 0 0.05 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n");
    const RunResult result =
        render_scene(scene_with("[[object]]\nmodel = \"texture.gltf\"\n"
                                "[[object]]\nmodel = \"bad.obj\"\ntranslate = [0.05, 0, 0]\n"
                                "[effects]\nchromatic_aberration = \"auto\"\nbloom = \"off\"\n"));
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"texture.gltf", "texture 'none.png' is missing"}));
    EXPECT_TRUE(warned_of(result, {"bad.obj", "2 triangles"}));
    EXPECT_TRUE(warned_of(result, {"chromatic aberration is not known", "left out"}));
    EXPECT_THAT(result.standard_error, testing::Not(HasSubstr("bloom")));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out.mp4"));
}

TEST_F(SceneCommand, AnyFileNameServes) {
    for (const std::string name : {"my model.obj", "größe.obj", "-rf.obj", "100%.obj"}) {
        write(name, "v 0 0.01 0\nv 0.05 0.01 0\nv 0 0.05 0\nf 1 2 3\n");
    }
    std::filesystem::rename(folder_ / "plate.mp4", folder_ / "-a plate.mp4");
    std::filesystem::rename(folder_ / "scene.solve.json", folder_ / "-the scene.solve.json");
    std::string text = scene_with(
        "[[object]]\nmodel = \"my model.obj\"\n[[object]]\nmodel = \"größe.obj\"\n"
        "[[object]]\nmodel = \"-rf.obj\"\n[[object]]\nmodel = \"100%.obj\"\n");
    text.replace(text.find("plate.mp4"), 9, "-a plate.mp4");
    write("-the scene.toml", text);
    RunOptions options;
    options.working_directory = folder_;
    // Where the machine has such a locale, decimal commas too.
    options.environment["LC_ALL"] = "de_DE.UTF-8";
    EXPECT_TRUE(succeeded(run_matchlight(
        {"render", "./-the scene.toml", "-o", "./-out file.mp4", "--frames", "0-0", "--level", "draft"}, options)));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "-out file.mp4"));
}

TEST_F(SceneCommand, TheSceneReferenceIsPrinted) {
    const RunResult result = run_matchlight({"render", "--help-scene"});
    EXPECT_TRUE(succeeded(result));
    for (const char* words :
         {"### `[footage]`", "| `exposure_ev` |", "### `[[object]]`", "| `crf` | whole number, from 0 to 51 |"}) {
        EXPECT_THAT(result.standard_output, HasSubstr(words));
    }
}

}  // namespace
}  // namespace matchlight::test
