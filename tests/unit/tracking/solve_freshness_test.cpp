// A solve is used for the scene it was made from, and for no other.
#include "tracking/solve_freshness.h"

#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class SolveFreshness : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("matchlight_freshness_" + std::to_string(getpid()));
        fs::create_directories(folder_);
        camera_ = {.width = 640,
                   .height = 360,
                   .fx = 622.2,
                   .fy = 622.2,
                   .cx = 319.5,
                   .cy = 179.5,
                   .distortion = {-0.09, 0.03, 5e-4, -3e-4, 0}};
        save_camera(folder_ / "camera.yaml", camera_);
        scene_.path = folder_ / "shot.toml";
        scene_.footage.solve = folder_ / "shot.solve.json";
        scene_.footage.camera = folder_ / "camera.yaml";
        scene_.effective_toml = text_;
        solve_.camera = camera_;
        solve_.rig = {{.id = 0, .size_m = 0.08, .world_from_tag = RigidTransform::Identity()}};
        solve_.provenance = "matchlight 0.1.0, track\n" + text_;
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// The scene with `before` replaced by `after` in its effective text.
    void change(const std::string& before, const std::string& after) {
        const std::size_t place = scene_.effective_toml.find(before);
        ASSERT_NE(place, std::string::npos);
        scene_.effective_toml.replace(place, before.size(), after);
    }
    std::string refusal() {
        try {
            check_solve_is_of_scene(solve_, scene_, warnings_);
        } catch (const InputError& error) {
            return error.what();
        }
        return {};
    }

    const std::string text_ =
        "[footage]\nvideo = \"a.mp4\"\ncamera = \"camera.yaml\"\nsolve = \"x.json\"\n\n"
        "[tags]\nrig = [{id = 0, size = 0.08}]\n\n[light]\nprobe = \"p.exr\"\nrotation_deg = 0\n\n"
        "[[object]]\nmodel = \"m.glb\"\n\n[output]\ncodec = \"h264\"\n";
    fs::path folder_;
    Camera camera_;
    Scene scene_;
    Solve solve_;
    Warnings warnings_;
};

TEST_F(SolveFreshness, AnUnchangedSceneIsTakenInSilence) {
    EXPECT_EQ(refusal(), "");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SolveFreshness, ObjectsAndOutputMayChange) {
    change("m.glb", "n.glb");
    change("h264", "ffv1");
    change("x.json", "y.json");  // only where the solve lies
    EXPECT_EQ(refusal(), "");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SolveFreshness, AnotherSizeOrPlaceOfATagIsRefused) {
    scene_.tags.rig = {{.id = 0, .size_m = 0.09, .world_from_tag = std::nullopt}};
    EXPECT_NE(refusal().find("tag 0 in [tags]"), std::string::npos);
    EXPECT_NE(refusal().find("shot.solve.json"), std::string::npos);
    EXPECT_NE(refusal().find("matchlight track"), std::string::npos);

    RigidTransform place = RigidTransform::Identity();
    scene_.tags.rig[0] = {.id = 0, .size_m = 0.08, .world_from_tag = place};
    EXPECT_EQ(refusal(), "");
    place.translation().x() = 0.001;
    scene_.tags.rig[0].world_from_tag = place;
    EXPECT_NE(refusal().find("tag 0 in [tags]"), std::string::npos);
    place = RigidTransform(Eigen::AngleAxisd(0.001, Eigen::Vector3d::UnitZ()));
    scene_.tags.rig[0].world_from_tag = place;
    EXPECT_NE(refusal().find("tag 0 in [tags]"), std::string::npos);
}

TEST_F(SolveFreshness, TagsThatContradictNothingAreTaken) {
    scene_.tags.rig = {{.id = 0, .size_m = 0.08, .world_from_tag = std::nullopt},
                       {.id = 5, .size_m = 0.05, .world_from_tag = RigidTransform::Identity()}};
    EXPECT_EQ(refusal(), "");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SolveFreshness, AnotherLensIsRefused) {
    Camera other = camera_;
    other.fx += 1e-6;
    save_camera(folder_ / "camera.yaml", other);
    EXPECT_NE(refusal().find("camera.yaml"), std::string::npos);
}

TEST_F(SolveFreshness, AnotherResponseIsRefused) {
    write_text_file(folder_ / "response.json", R"({"family": "gamma", "gamma": 2.2})");
    scene_.footage.response = folder_ / "response.json";
    EXPECT_NE(refusal().find("response"), std::string::npos);
    solve_.response = Response::gamma(2.2);
    EXPECT_EQ(refusal(), "");
    scene_.footage.response.reset();  // back to sRGB
    EXPECT_NE(refusal().find("response"), std::string::npos);
    solve_.response = Response::pq();  // as the footage itself says
    EXPECT_EQ(refusal(), "");
}

TEST_F(SolveFreshness, OtherColoursOfTheFootageAreRefused) {
    change("video = ", "color_matrix = \"bt601\"\nvideo = ");
    EXPECT_NE(refusal().find("[footage]"), std::string::npos);
}

TEST_F(SolveFreshness, AnotherLightOrVideoIsAWarning) {
    change("rotation_deg = 0", "rotation_deg = 90");
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(warnings_.total(), 1);
    change("a.mp4", "proxy.mp4");
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(warnings_.entries().size(), 2u);
}

TEST_F(SolveFreshness, ASolveOfAnotherProgramIsTakenAsItIs) {
    solve_.provenance.clear();
    scene_.tags.rig = {{.id = 0, .size_m = 0.09, .world_from_tag = std::nullopt}};
    solve_.camera.fx = 1;
    EXPECT_EQ(refusal(), "");
}

}  // namespace
}  // namespace matchlight
