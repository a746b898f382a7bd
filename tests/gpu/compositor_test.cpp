// The compositor as a whole: what it leaves out of a frame changes no bit of it.
#include "compositor/compositor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "grey_plate.h"
#include "scene/depth_of_field_levels.h"

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

/// Each way in which bright light spills, for light above `threshold`.
std::map<std::string, EffectSettings> each_effect(double threshold) {
    std::map<std::string, EffectSettings> effects;
    for (const BloomLevel level : {BloomLevel::classic, BloomLevel::pyramid, BloomLevel::reference}) {
        effects["bloom " + std::to_string(static_cast<int>(level))].bloom =
            BloomSettings{.level = level, .threshold = threshold};
    }
    for (const GlareLevel level :
         {GlareLevel::classic, GlareLevel::streaks, GlareLevel::diffraction, GlareLevel::reference}) {
        effects["glare " + std::to_string(static_cast<int>(level))].glare =
            GlareSettings{.level = level, .threshold = threshold};
    }
    effects["halo"].glare = GlareSettings{.threshold = threshold, .halo = 1};
    EffectSettings& dazzle = effects["dazzling reflection"];
    dazzle.glare = GlareSettings{.threshold = threshold};
    dazzle.dazzle = DazzleSettings{.strength = 2, .glare = GlareSettings{.threshold = threshold, .directions = 3}};
    return effects;
}

TEST_F(CompositorTest, EffectsWithoutBrightLight) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    for (const auto& [name, effects] : each_effect(1e5)) {
        shot.scene.effects = effects;
        const CompositedFrame asked_for = composite(shot, true);
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), asked_for.rgb16().samples())) << name;
        EXPECT_FALSE(was_drawn("response around")) << name;
        int left_out = 0;
        for (const PassReport& report : reports_) {
            const bool is_effect = (report.name.starts_with("bloom/") || report.name.starts_with("glare/") ||
                                    report.name.starts_with("dazzle glare/")) &&
                                   report.name.find("bright") == std::string::npos &&
                                   report.name.find("kernel") == std::string::npos;
            EXPECT_FALSE(is_effect && report.drawn) << name << ": " << report.name;
            left_out += is_effect ? 1 : 0;
        }
        EXPECT_GT(left_out, 0) << name;
        const CompositedFrame whole = composite(shot, false);
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), whole.rgb16().samples())) << name;
    }
}

TEST_F(CompositorTest, EachEffectAddsLight) {
    Shot shot = make_shot();
    shot.solve.frames[0].exposure_ev = 2;
    const CompositedFrame plain = composite(shot, true);
    for (const auto& [name, effects] : each_effect(0.8)) {
        shot.scene.effects = effects;
        const Image8 before = plain.rgb8(), after = composite(shot, true).rgb8();
        std::int64_t brighter = 0, darker = 0;
        for (std::size_t i = 0; i < before.samples().size(); ++i) {
            brighter += after.samples()[i] > before.samples()[i];
            darker += after.samples()[i] < before.samples()[i];
        }
        EXPECT_GT(brighter, 500) << name;
        EXPECT_EQ(darker, 0) << name;
    }
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

TEST_F(CompositorTest, DepthOfFieldWhereAllIsInFocus) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    DepthOfFieldSettings& settings = shot.scene.effects.depth_of_field.emplace();
    settings.focus_distance_m = 0.6;
    settings.coc_scale_px_m = 0.2;
    expect_same_without(shot, "resolve");
    Warnings warnings;
    warnings.set_quiet(true);
    Compositor whole(context(), shot.scene, shot.solve, {.quality = shot.scene.quality, .leave_out = false}, warnings);
    for (const DepthOfFieldLevel level :
         {DepthOfFieldLevel::two_pass, DepthOfFieldLevel::one_pass, DepthOfFieldLevel::layers,
          DepthOfFieldLevel::mipmap, DepthOfFieldLevel::diffusion}) {
        settings.level = level;
        const auto drawn = [&](double coc_scale_px_m) {
            settings.coc_scale_px_m = coc_scale_px_m;
            whole.set_effects(shot.scene.effects);
            CompositedFrame frame = whole.composite(test::grey_plate(320, 180, plate_luma_));
            reports_ = whole.reports();
            EXPECT_TRUE(was_drawn("depth of field/circles")) << static_cast<int>(level);
            return frame;
        };
        const CompositedFrame sharp = drawn(0.2), blurred = drawn(20);
        EXPECT_TRUE(std::ranges::equal(sharp.rgb16().samples(), plain.rgb16().samples())) << static_cast<int>(level);
        EXPECT_FALSE(std::ranges::equal(blurred.rgb16().samples(), plain.rgb16().samples())) << static_cast<int>(level);
    }
}

/// Every method, focused on the ball's middle, its circles this wide at most.
std::vector<EffectSettings> each_depth_of_field(double widest_px) {
    std::vector<EffectSettings> all;
    const RigidTransform camera_from_world = test::camera_before_the_table();
    const Eigen::Vector3d middle_m(0, 0, 0.03);
    for (std::size_t i = 0; i < depth_of_field_levels.size(); ++i) {
        DepthOfFieldSettings& lens = all.emplace_back().depth_of_field.emplace();
        lens.level = static_cast<DepthOfFieldLevel>(i);
        lens.lens_samples = 5;
        lens.focus_distance_m = (camera_from_world * middle_m).z();
        // The box around the ball, 5 cm wide, holds all its depths.
        const double half_m = 0.025 * std::sqrt(3.0);
        lens.coc_scale_px_m = widest_px / (1 / (*lens.focus_distance_m - half_m) - 1 / *lens.focus_distance_m);
    }
    return all;
}

TEST_F(CompositorTest, CirclesOfLessThanAQuarterPixelAreNone) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    for (const EffectSettings& effects : each_depth_of_field(0.99 * least_coc_px)) {
        const std::string_view name = depth_of_field_levels[static_cast<std::size_t>(effects.depth_of_field->level)];
        shot.scene.effects = effects;
        const CompositedFrame lean = composite(shot, true);
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), lean.rgb16().samples())) << name;
        const CompositedFrame whole = composite(shot, false);
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), whole.rgb16().samples())) << name;
    }
}

TEST_F(CompositorTest, EveryDepthOfFieldIsTheSameInAnyOrder) {
    Shot shot = make_shot();
    shot.solve.frame_count = 2;
    SolvedFrame second = shot.solve.frames[0];
    second.frame = 1;
    second.camera_from_world->pretranslate(Eigen::Vector3d(0.02, 0, 0.05));
    shot.solve.frames.push_back(second);
    Warnings warnings;
    warnings.set_quiet(true);
    for (const EffectSettings& effects : each_depth_of_field(12)) {
        const std::string_view name = depth_of_field_levels[static_cast<std::size_t>(effects.depth_of_field->level)];
        shot.scene.effects = effects;
        const auto codes = [&](const std::vector<int>& order) {
            Compositor compositor(context(), shot.scene, shot.solve, {.quality = QualityLevel::draft}, warnings);
            std::map<int, Image16> frames;
            for (const int index : order)
                frames[index] = compositor.composite(test::grey_plate(320, 180, 120, index)).rgb16();
            return frames;
        };
        const auto forwards = codes({0, 1}), backwards = codes({1, 0}), alone = codes({1});
        for (const int index : {0, 1}) {
            EXPECT_TRUE(std::ranges::equal(forwards.at(index).samples(), backwards.at(index).samples())) << name;
        }
        EXPECT_TRUE(std::ranges::equal(forwards.at(1).samples(), alone.at(1).samples())) << name;
        EXPECT_FALSE(std::ranges::equal(forwards.at(0).samples(), forwards.at(1).samples())) << name;
    }
}

TEST_F(CompositorTest, WhatDepthOfFieldLeavesOutChangesNothing) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    for (const EffectSettings& effects : each_depth_of_field(12)) {
        const std::string_view name = depth_of_field_levels[static_cast<std::size_t>(effects.depth_of_field->level)];
        shot.scene.effects = effects;
        const CompositedFrame lean = composite(shot, true), whole = composite(shot, false);
        EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole.rgb16().samples())) << name;
        EXPECT_FALSE(std::ranges::equal(lean.rgb16().samples(), plain.rgb16().samples())) << name;
    }
}

}  // namespace
}  // namespace matchlight
