// Scenes without footage: their settings, and where their camera is at each frame.
#include "scene/virtual_camera.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "scene/scene_file.h"
#include "temporary_folder.h"

namespace matchlight {
namespace {

using testing::HasSubstr;

const char* const orbiting_camera = "[camera]\nwidth = 800\nheight = 600\norbit = {radius = 0.6}\n";  // lines 1 to 4

class SceneWithoutFootage : public TemporaryFolder {
protected:
    void SetUp() override {
        TemporaryFolder::SetUp();
        warnings_.set_quiet(true);
        for (const char* name : {"clip.mp4", "camera.yaml", "room.exr", "sky.png"}) write(name, "x");
    }
    Scene load(const std::string& text) { return load_scene(write("scene.toml", text), warnings_); }
    std::string error_of(const std::string& text) {
        try {
            load(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
    Warnings warnings_;
};

TEST_F(SceneWithoutFootage, NeedsNoTagsAndHasNoSurface) {
    const Scene scene = load(orbiting_camera);
    ASSERT_TRUE(scene.camera && scene.camera->orbit);
    EXPECT_EQ(scene.camera->width, 800);
    EXPECT_EQ(scene.camera->height, 600);
    EXPECT_EQ(scene.camera->frames, 1);
    EXPECT_EQ(scene.camera->fps, 25);
    EXPECT_EQ(scene.camera->orbit->radius_m, 0.6);
    EXPECT_FALSE(scene.background.probe || scene.background.color || !scene.background.image.empty());
    EXPECT_FALSE(scene.surface.present);
    EXPECT_TRUE(scene.footage.video.empty() && scene.footage.solve.empty());
    EXPECT_THAT(scene.effective_toml, HasSubstr("[surface]\nenabled = false"));
    EXPECT_TRUE(load(std::string(orbiting_camera) + "[surface]\nz = 0.1\n").surface.present);
}

TEST_F(SceneWithoutFootage, EverySettingArrives) {
    const Scene scene = load(R"([camera]
width = 641
height = 3
frames = 180
fps = 29.97
vertical_fov_deg = 65
exposure_ev = -2
keys = [{frame = 0, eye = [1, 2, 3], target = [0, 0, 0]}, {frame = 9, eye = [4, 5, 6], target = [0, 0, 1]}]
lens = {f_number = 1.4, focus_distance_m = 0.7, sensor_width_mm = 24}
[light]
probe = "room.exr"
[background]
probe = true
)");
    EXPECT_EQ(scene.camera->keys.size(), 2u);
    EXPECT_EQ(scene.camera->keys[1].frame, 9);
    EXPECT_EQ(scene.camera->keys[1].eye_m, Eigen::Vector3d(4, 5, 6));
    EXPECT_EQ(scene.camera->keys[1].target_m, Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(scene.camera->lens->f_number, 1.4);
    EXPECT_EQ(scene.camera->lens->focus_distance_m, 0.7);
    EXPECT_EQ(scene.camera->lens->sensor_width_mm, 24);
    EXPECT_EQ(scene.camera->exposure_ev, -2);
    EXPECT_TRUE(scene.background.probe);
    EXPECT_EQ(load(std::string(orbiting_camera) + "[background]\ncolor = [1, 2, 3]\n").background.color,
              (std::array<double, 3>{1, 2, 3}));
}

TEST_F(SceneWithoutFootage, MistakesNameTheLineAndTheCure) {
    const std::string camera = orbiting_camera;
    const std::string footage = "[footage]\nvideo = \"clip.mp4\"\ncamera = \"camera.yaml\"\n";
    const std::vector<std::pair<std::string, std::string>> rows = {
        {footage + camera, "scene.toml:4: [camera] belongs to scenes without footage"},
        {"[light]\nprobe = \"room.exr\"\n", "neither footage nor a camera"},
        {footage, "'rig' is missing in [tags]"},
        {footage + "[background]\nprobe = true\n", "scene.toml:4: [background] belongs to scenes without footage"},
        {"[camera]\nwidth = 800\norbit = {radius = 1}\n", "'height' is missing in [camera]"},
        {"[camera]\nwidth = 0\nheight = 600\n", "scene.toml:2: 'width' in [camera] is 0, outside its range"},
        {"[camera]\nwidth = 1e9\nheight = 600\n", "scene.toml:2: 'width' in [camera]"},
        {"[camera]\nwidth = 8\nheight = 6\n", "scene.toml:1: [camera] has neither of orbit and keys; give one"},
        {camera + "keys = [{frame = 0, eye = [1, 0, 0], target = [0, 0, 0]}]\n", "has both of orbit and keys"},
        {camera + "vertical_fov_deg = 180\n", "scene.toml:5: 'vertical_fov_deg' in [camera] is 180"},
        {camera + "vertical_fov_deg = nan\n", "scene.toml:5: 'vertical_fov_deg' in [camera] is not finite"},
        {camera + "fps = 0\n", "scene.toml:5: 'fps' in [camera] is 0"},
        {camera + "frames = 0\n", "scene.toml:5: 'frames' in [camera] is 0"},
        {camera + "vertical_fov_degree = 40\n", "did you mean 'vertical_fov_deg'?"},
        {"[camera]\nwidth = 8\nheight = 6\norbit = {radius = 0}\n", "scene.toml:4: 'radius' in [camera.orbit] is 0"},
        {"[camera]\nwidth = 8\nheight = 6\nkeys = [{frame = 3, eye = [1, 0, 0], target = [0, 0, 0]},\n"
         "{frame = 3, eye = [1, 0, 0], target = [0, 0, 0]}]\n",
         "scene.toml:5: keys of [camera]: frame 3 does not come after 3"},
        {"[camera]\nwidth = 8\nheight = 6\nkeys = [{frame = 0, eye = [1, 0, 0], target = [1, 0, 0]}]\n",
         "scene.toml:4: keys of [camera]: at frame 0 eye and target are one point"},
        {camera + "[background]\nprobe = true\n", "scene.toml:5: [background] shows the probe, but the scene has none"},
        {camera + "[background]\ncolor = [1, 1, 1]\nimage = \"sky.png\"\n", "more than one of probe, color and image"},
        {camera + "[background]\nimage = \"none.png\"\n", "scene.toml:6: 'image' in [background]: there is no file"},
        {camera + "[background]\ncolor = [1, -1, 1]\n", "scene.toml:6: 'color' in [background]"},
    };
    for (const auto& [text, expected] : rows) EXPECT_THAT(error_of(text), HasSubstr(expected)) << text;
}

TEST_F(SceneWithoutFootage, DepthOfFieldNeedsNoFootage) {
    const std::string camera = std::string(orbiting_camera) + "lens = {focus_distance_m = 0.5}\n";
    EXPECT_FALSE(load(camera).effects.depth_of_field);
    EXPECT_TRUE(load(camera + "[effects]\ndepth_of_field = \"auto\"\n").effects.depth_of_field);
    EXPECT_TRUE(warnings_.empty());
}

CameraSettings orbit(double elevation_deg, double from_deg, double to_deg, std::int64_t frames) {
    CameraSettings camera;
    camera.frames = frames;
    camera.orbit = OrbitSettings{
        .target_m = {1, 2, 3}, .radius_m = 2, .elevation_deg = elevation_deg, .from_deg = from_deg, .to_deg = to_deg};
    return camera;
}

TEST(CameraView, OrbitsCounterClockwiseFromPlusX) {
    const CameraSettings camera = orbit(0, 0, 180, 3);
    EXPECT_TRUE(camera_view(camera, 0).eye_m.isApprox(Eigen::Vector3d(3, 2, 3), 1e-12));
    EXPECT_TRUE(camera_view(camera, 1).eye_m.isApprox(Eigen::Vector3d(1, 4, 3), 1e-12));
    EXPECT_TRUE(camera_view(camera, 2).eye_m.isApprox(Eigen::Vector3d(-1, 2, 3), 1e-12));
    const CameraView raised = camera_view(orbit(30, 90, 90, 1), 0);
    EXPECT_TRUE(raised.eye_m.isApprox(Eigen::Vector3d(1, 2 + std::sqrt(3.0), 4), 1e-12));
    EXPECT_EQ(raised.target_m, Eigen::Vector3d(1, 2, 3));
}

/// Keys on a parabola in time, unevenly spaced.
CameraSettings parabola() {
    CameraSettings camera;
    for (const std::int64_t frame : {0, 3, 4, 10, 12}) {
        const auto t = static_cast<double>(frame);
        camera.keys.push_back({frame, {t, t * t, 1}, {0, 2 * t, 0}});
    }
    return camera;
}

TEST(CameraView, GoesThroughItsKeysAndRestsBeyond) {
    const CameraSettings camera = parabola();
    for (const CameraKey& key : camera.keys) {
        EXPECT_TRUE(camera_view(camera, static_cast<double>(key.frame)).eye_m.isApprox(key.eye_m, 1e-12));
    }
    EXPECT_EQ(camera_view(camera, 100).eye_m, camera.keys.back().eye_m);
    EXPECT_EQ(camera_view(camera, -1).target_m, camera.keys.front().target_m);
}

TEST(CameraView, IsExactOnLinesAndInsideParabolas) {
    const CameraSettings camera = parabola();
    for (double frame = 0; frame <= 12; frame += 0.25) {
        EXPECT_NEAR(camera_view(camera, frame).eye_m.x(), frame, 1e-12) << frame;
        EXPECT_NEAR(camera_view(camera, frame).target_m.y(), 2 * frame, 1e-12) << frame;
        // The outermost spans have a neighbour on one side only.
        if (frame < 3 || frame > 10) continue;
        EXPECT_NEAR(camera_view(camera, frame).eye_m.y(), frame * frame, 1e-11) << frame;
    }
}

TEST(CameraView, HasNoKinks) {
    const CameraSettings camera = parabola();
    constexpr double step = 1e-6;
    for (const double frame : {3.0, 4.0, 10.0}) {
        const Eigen::Vector3d at = camera_view(camera, frame).eye_m;
        const Eigen::Vector3d before = (at - camera_view(camera, frame - step).eye_m) / step;
        const Eigen::Vector3d after = (camera_view(camera, frame + step).eye_m - at) / step;
        EXPECT_LT((after - before).norm(), 1e-4) << frame;
    }
}

}  // namespace
}  // namespace matchlight
