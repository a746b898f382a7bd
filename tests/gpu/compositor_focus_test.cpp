// Depth of field in whole frames: what is in focus, and what is left out of the rest, is the same bit for bit.
#include <algorithm>
#include <map>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "compositor_shot.h"
#include "scene/depth_of_field_levels.h"

namespace matchlight {
namespace {

using test::CompositorTest, test::make_shot, test::Shot;

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
    shot.scene.surface.shadow = false;  // the surface lies farther from the focus
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

TEST_F(CompositorTest, ASkydomeIsSeenThroughTheLensToo) {
    Shot shot = make_shot();
    shot.scene.camera.emplace();
    shot.scene.camera->width = 320;
    shot.scene.camera->height = 180;
    shot.scene.surface.present = false;
    shot.solve.camera.distortion = {};
    shot.scene.background.probe = true;
    const CompositedFrame plain = composite(shot, true);
    DepthOfFieldSettings lens;
    lens.focus_distance_m = 0.6;
    const auto with = [&](double coc_px, DepthOfFieldLevel level) {
        lens.level = level;
        lens.lens_samples = 3;
        lens.coc_scale_px_m = coc_px * *lens.focus_distance_m;
        shot.scene.effects.depth_of_field = lens;
    };
    with(0.2, DepthOfFieldLevel::gather);
    const CompositedFrame sharp = composite(shot, true);
    EXPECT_FALSE(was_drawn("background defocus/gather"));
    const CompositedFrame whole = composite(shot, false);
    EXPECT_TRUE(was_drawn("background defocus/gather"));
    EXPECT_TRUE(std::ranges::equal(sharp.rgb16().samples(), whole.rgb16().samples()));
    // Beside the ball, whose own circles are narrower still, all is as without depth of field.
    EXPECT_TRUE(std::ranges::equal(sharp.code.row(5), plain.code.row(5)));

    for (const DepthOfFieldLevel level : {DepthOfFieldLevel::gather, DepthOfFieldLevel::lens_samples}) {
        with(9, level);
        const CompositedFrame blurred = composite(shot, true);
        EXPECT_TRUE(was_drawn("background defocus/gather"));
        EXPECT_FALSE(std::ranges::equal(blurred.code.row(5), plain.code.row(5)));
        EXPECT_TRUE(std::ranges::equal(blurred.rgb16().samples(), composite(shot, false).rgb16().samples()));
    }
    // An even colour stays what it is.
    shot.scene.background = {.probe = false, .color = {{0.2, 0.3, 0.4}}, .image = {}};
    const CompositedFrame even = composite(shot, true);
    EXPECT_FALSE(was_drawn("background defocus/gather"));
    EXPECT_EQ(even.code.at(5, 5, 0), even.code.at(300, 5, 0));
}

}  // namespace
}  // namespace matchlight
