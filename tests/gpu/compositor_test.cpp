// The compositor as a whole: what it leaves out of a frame changes no bit of it.
#include "compositor/compositor.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "grey_plate.h"

namespace matchlight {
namespace {

struct Shot {
    Scene scene;
    Solve solve;
};

/// A chrome ball on the sample's table, or what `change` makes of it.
Shot make_shot() {
    Shot shot;
    Warnings warnings;
    warnings.set_quiet(true);
    const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
    shot.scene = load_scene(folder / "table.toml", warnings);
    shot.scene.quality = QualityLevel::draft;
    shot.solve.camera = camera_for_size(load_camera(folder / "camera.yaml"), 320, 180, folder / "camera.yaml");
    SolvedFrame frame;
    frame.camera_from_world = test::camera_before_the_table();
    frame.exposure_ev = -1;
    shot.solve.frames.push_back(frame);
    ObjectSettings ball;
    ball.shape = "sphere";
    ball.name = "ball";
    ball.scale.setConstant(0.05);
    ball.translate_m.z() = 0.03;
    ball.material.metallic = 1;
    ball.material.roughness = 0;
    shot.scene.objects = {ball};
    return shot;
}

class CompositorTest : public GlTest {
protected:
    CompositedFrame composite(const Shot& shot, bool leave_out) {
        Warnings warnings;
        warnings.set_quiet(true);
        Compositor compositor(context(), shot.scene, shot.solve,
                              {.quality = shot.scene.quality, .leave_out = leave_out}, warnings);
        CompositedFrame frame = compositor.composite(test::grey_plate(320, 180));
        reports_ = compositor.reports();
        return frame;
    }
    bool was_drawn(const std::string& pass) const {
        return std::any_of(reports_.begin(), reports_.end(),
                           [&](const PassReport& report) { return report.name == pass && report.drawn; });
    }
    /// The frame with everything drawn is the frame with passes left out, and `pass` is among those.
    void expect_same_without(const Shot& shot, const std::string& pass) {
        const CompositedFrame lean = composite(shot, true);
        EXPECT_FALSE(was_drawn(pass)) << pass;
        const CompositedFrame whole = composite(shot, false);
        EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole.rgb16().samples())) << pass;
        EXPECT_EQ(whole.reach, (Region{0, 0, 320, 180})) << "everything was drawn";
    }

    std::vector<PassReport> reports_;
};

TEST_F(CompositorTest, ASphereMapThatNothingReflects) {
    expect_same_without(make_shot(), "light/sphere map");
}

TEST_F(CompositorTest, ACubeThatNothingReflects) {
    Shot shot = make_shot();
    shot.scene.objects[0].reflection = ReflectionForm::sphere_map;
    shot.scene.objects[0].material.specular = {0.9, 0.9, 0.9};
    expect_same_without(shot, "light/reflection cube");
}

TEST_F(CompositorTest, ShadowsOfNothing) {
    Shot shot = make_shot();
    shot.scene.objects[0].casts_shadow = false;
    expect_same_without(shot, "shadow/contact");
    shot.scene.quality = QualityLevel::preview;
    expect_same_without(shot, "shadow/between objects");
}

TEST_F(CompositorTest, ObjectsOutOfView) {
    Shot shot = make_shot();
    shot.scene.objects[0].translate_m.y() = 50;
    shot.scene.objects[0].translate_m.x() = 200;
    expect_same_without(shot, "surface");
}

TEST_F(CompositorTest, TilesThatNothingReaches) {
    const Shot shot = make_shot();
    const CompositedFrame lean = composite(shot, true);
    EXPECT_LT(lean.reach.width * lean.reach.height, 320 * 180);
    const CompositedFrame whole = composite(shot, false);
    EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole.rgb16().samples()));
    const auto is_touched = [](std::uint8_t touched) { return touched > 0; };
    EXPECT_EQ(std::ranges::count_if(lean.touched.samples(), is_touched),
              std::ranges::count_if(whole.touched.samples(), is_touched));
}

}  // namespace
}  // namespace matchlight
