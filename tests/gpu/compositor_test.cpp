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
        CompositedFrame frame = compositor.composite(test::grey_plate(320, 180, plate_luma_));
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
    std::uint8_t plate_luma_ = 120;
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

TEST_F(CompositorTest, EffectsWithoutBrightLight) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.bloom.emplace().threshold = 1e5;
    const CompositedFrame asked_for = composite(shot, true);
    EXPECT_FALSE(was_drawn("response around"));
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), asked_for.rgb16().samples()));
    for (const PassReport& report : reports_) {
        const bool is_bloom = report.name.starts_with("bloom/");
        EXPECT_FALSE(is_bloom && report.drawn) << report.name;
    }
    const CompositedFrame whole = composite(shot, false);
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), whole.rgb16().samples()));
}

TEST_F(CompositorTest, LightSpillsBeyondTheObjects) {
    Shot shot = make_shot();
    shot.solve.frames[0].exposure_ev = 2;
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.bloom.emplace().strength = 1;
    const CompositedFrame bloomed = composite(shot, true);
    EXPECT_TRUE(was_drawn("response around"));
    const Image8 before = plain.rgb8(), after = bloomed.rgb8();
    std::int64_t brighter = 0, darker = 0;
    for (std::size_t i = 0; i < before.samples().size(); ++i) {
        brighter += after.samples()[i] > before.samples()[i];
        darker += after.samples()[i] < before.samples()[i];
    }
    EXPECT_GT(brighter, 10'000);
    EXPECT_EQ(darker, 0);
    // Drawn tile by tile or at once, the picture is the same.
    const CompositedFrame whole = composite(shot, false);
    EXPECT_TRUE(std::ranges::equal(bloomed.rgb16().samples(), whole.rgb16().samples()));
}

TEST_F(CompositorTest, AnObjectBeforeALampTakesTheLampsBloomAway) {
    Shot shot = make_shot();
    plate_luma_ = 235;  // white: the whole plate is a lamp
    shot.scene.surface.shadow = false;
    shot.scene.objects[0].material.metallic = 0;
    shot.scene.objects[0].material.base_color = {0, 0, 0};
    shot.scene.objects[0].material.roughness = 1;
    shot.solve.frames[0].exposure_ev = -8;
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.bloom = BloomSettings{.threshold = 0.25, .strength = 1};
    const CompositedFrame frame = composite(shot, true);
    const Image8 before = plain.rgb8(), after = frame.rgb8();
    int dimmed = 0;
    for (int y = 0; y < 180; ++y) {
        for (int x = 0; x < 320; ++x) dimmed += before.at(x, y, 1) == 255 && after.at(x, y, 1) < 250;
    }
    EXPECT_GT(dimmed, 500) << "around the black ball the plate loses a part of its glow";
}

}  // namespace
}  // namespace matchlight
