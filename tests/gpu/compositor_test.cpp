// The compositor as a whole: what it leaves out of a frame changes no bit of it.
#include "compositor/compositor.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "compositor_shot.h"

namespace matchlight {
namespace {

using test::CompositorTest, test::make_shot, test::Shot;

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

}  // namespace
}  // namespace matchlight
