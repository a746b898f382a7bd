// What objects do to each other's light in a whole frame: mirrored, bounced, and left out where there is nothing to
// meet.
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "compositor_shot.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

/// Pixels of the ball (id 1) that are much redder than green.
int red_on_the_ball(const FrameLayers& layers, float least = 0.5F) {
    int red = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            if (layers.object_id.at(x, y, 0) != 1) continue;
            red += layers.beauty.at(x, y, 0) > 3 * layers.beauty.at(x, y, 1) && layers.beauty.at(x, y, 0) > least;
        }
    }
    return red;
}

class NearLightTest : public CompositorTest {
protected:
    /// A chrome ball, and a red box that glows beside it.
    static Shot ball_and_lamp(QualityLevel level) {
        Shot shot = make_shot();
        shot.scene.quality = level;
        ObjectSettings lamp;
        lamp.shape = "box";
        lamp.name = "lamp";
        lamp.scale.setConstant(0.04);
        lamp.translate_m = {0.07, 0, 0.03};
        lamp.material.base_color = {0, 0, 0};
        lamp.material.emissive = {8, 0, 0};
        shot.scene.objects.push_back(lamp);
        return shot;
    }

    /// The same with a red sphere in the box's place, a set of one or a mesh.
    static Shot ball_and_sphere(bool is_set, const std::array<double, 3>& emissive) {
        Shot shot = ball_and_lamp(QualityLevel::draft);
        ObjectSettings& sphere = shot.scene.objects.back();
        sphere.shape = is_set ? "" : "sphere";
        sphere.scale.setConstant(0.08);
        sphere.translate_m = {0.1, 0, 0.04};
        sphere.material = {};
        sphere.material.emissive = emissive;
        if (is_set) {
            sphere.spheres = fs::temp_directory_path() / fmt::format("matchlight_near_light_{}.csv", ::getpid());
            std::ofstream(sphere.spheres) << "x,y,z,radius,red,green,blue\n0,0,0,0.5,255,0,0\n";
        } else {
            sphere.material.base_color = {1, 0, 0};
        }
        return shot;
    }
    int red_on_the_ball_of(Shot shot, ReflectionLevel reflections) {
        constexpr float lit = 0.02F;  // by the probe
        shot.scene.reflections = reflections;
        shot.scene.bounce = false;
        Compositor compositor(context(), shot.scene, shot.solve, {.quality = shot.scene.quality, .layers = true},
                              warnings_);
        return red_on_the_ball(*compositor.composite(grey_plate(320, 180, plate_luma_)).layers, lit);
    }

    /// With fewer rays than the levels have: enough for what is looked at.
    CompositedFrame with_layers(const Shot& shot, bool leave_out = true) {
        Warnings warnings;
        warnings.set_quiet(true);
        Quality quality = quality_of(shot.scene.quality);
        if (quality.bounce.rays > 0)
            quality.bounce = {.rays = 8, .surface_rays = 64, .bounces = 1, .surface_points = 24};
        Compositor compositor(context(), shot.scene, shot.solve,
                              {.settings = quality, .layers = true, .leave_out = leave_out}, warnings);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        reports_ = compositor.reports();
        return frame;
    }

    Warnings warnings_;

    std::string why_left_out(const std::string& pass) const {
        const auto found = std::ranges::find(reports_, pass, &PassReport::name);
        return found == reports_.end() || found->drawn ? std::string() : found->why;
    }
};

TEST_F(NearLightTest, AMirrorShowsWhatStandsBesideIt) {
    const CompositedFrame far = with_layers(ball_and_lamp(QualityLevel::preview));
    const CompositedFrame near = with_layers(ball_and_lamp(QualityLevel::final_));
    ASSERT_TRUE(far.layers && near.layers);
    // A few pixels hold the lamp's edge besides.
    EXPECT_GT(red_on_the_ball(*near.layers), red_on_the_ball(*far.layers) + 30);
}

TEST_F(NearLightTest, AMirrorShowsSpheresAsItShowsMeshesOfThem) {
    const int beside = red_on_the_ball_of(ball_and_sphere(true, {0, 0, 0}), ReflectionLevel::plane);
    for (const double glow : {0.0, 8.0}) {
        const int of_set = red_on_the_ball_of(ball_and_sphere(true, {glow, 0, 0}), ReflectionLevel::rays);
        const int of_mesh = red_on_the_ball_of(ball_and_sphere(false, {glow, 0, 0}), ReflectionLevel::rays);
        EXPECT_GT(of_set, beside + 15) << glow;
        EXPECT_NEAR(of_set, of_mesh, 2) << glow;
    }
    fs::remove(ball_and_sphere(true, {}).scene.objects.back().spheres);
}

TEST_F(NearLightTest, WhatGlowsLightsTheTable) {
    const auto brightest = [](const ImageF& shadow, int channel) {
        float most = 0;
        for (int y = 0; y < shadow.height(); ++y) {
            for (int x = 0; x < shadow.width(); ++x) most = std::max(most, shadow.at(x, y, channel));
        }
        return most;
    };
    const CompositedFrame far = with_layers(ball_and_lamp(QualityLevel::preview));
    EXPECT_LE(brightest(far.layers->shadow, 0), 1.0F + 1e-5F);
    const CompositedFrame near = with_layers(ball_and_lamp(QualityLevel::final_));
    EXPECT_GT(brightest(near.layers->shadow, 0), 1.2F) << "red light falls on the table";
    EXPECT_LT(brightest(near.layers->shadow, 1), 1.1F) << "and no more green than the ball throws back";
}

TEST_F(NearLightTest, ColouredSpheresBounceTheirLightAsMeshesOfThemDo) {
    // A red sphere and a green one side by side, none glowing, and a dark ball far from them, beside which rays meet
    // sets. Without rays the colours are guessed of all that casts in a direction, which mixes them.
    constexpr double radius_m = 0.04, apart_m = 0.05;
    const fs::path file = fs::temp_directory_path() / fmt::format("matchlight_bounce_{}.csv", ::getpid());
    std::ofstream(file) << fmt::format("x,y,z,radius,red,green,blue\n{0},0,0,{1},255,0,0\n-{0},0,0,{1},0,255,0\n",
                                       apart_m, radius_m);
    Shot of_meshes = make_shot();
    of_meshes.scene.objects.front().translate_m.x() = -0.4;
    Shot of_set = of_meshes;
    ObjectSettings sphere;
    sphere.name = "coloured";
    sphere.translate_m.z() = radius_m;
    sphere.spheres = file;
    of_set.scene.objects.push_back(sphere);
    sphere.spheres.clear();
    sphere.shape = "sphere";
    sphere.scale.setConstant(2 * radius_m);
    for (const double side : {1.0, -1.0}) {
        sphere.translate_m.x() = side * apart_m;
        sphere.material.base_color = side > 0 ? std::array{1.0, 0.0, 0.0} : std::array{0.0, 1.0, 0.0};
        of_meshes.scene.objects.push_back(sphere);
    }
    Quality quality = quality_of(QualityLevel::draft);
    quality.reflection.level = ReflectionLevel::rays;
    const auto red_and_green = [&](const Shot& shot, int rays) {
        quality.bounce = {.rays = rays, .surface_rays = 64, .bounces = 1, .surface_points = 24};
        Compositor compositor(context(), shot.scene, shot.solve, {.settings = quality, .layers = true}, warnings_);
        const FrameLayers layers = *compositor.composite(grey_plate(320, 180, plate_luma_)).layers;
        Eigen::Array2d sums(0, 0);
        for (int y = 0; y < layers.shadow.height(); ++y) {
            for (int x = 0; x < layers.shadow.width(); ++x) {
                const double redder = layers.shadow.at(x, y, 0) - layers.shadow.at(x, y, 1);
                if (layers.alpha.at(x, y) == 0) sums[redder > 0 ? 0 : 1] += std::abs(redder);
            }
        }
        return sums;
    };
    const Eigen::Array2d by_set = red_and_green(of_set, 8), by_meshes = red_and_green(of_meshes, 8);
    const Eigen::Array2d guessed = red_and_green(of_set, 0);
    fs::remove(file);
    for (const int side : {0, 1}) {
        EXPECT_GT(by_set[side], 10) << "both colours fall on the table";
        EXPECT_LT(guessed[side], 0.5 * by_set[side]) << "and only rays know which is where";
        EXPECT_NEAR(by_set[side] / by_meshes[side], 1, 0.1);
    }
}

TEST_F(NearLightTest, TheSceneSaysWhatTheLevelDoesNot) {
    const auto frame_of = [&](const Shot& shot) {
        warnings_.set_quiet(true);
        Compositor compositor(context(), shot.scene, shot.solve, {.quality = shot.scene.quality, .layers = true},
                              warnings_);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        reports_ = compositor.reports();
        return frame;
    };
    Shot draft = ball_and_lamp(QualityLevel::draft);
    EXPECT_LT(red_on_the_ball(*frame_of(draft).layers), 10);
    EXPECT_EQ(why_left_out("light/bounced"), "this quality level traces no rays");
    draft.scene.reflections = ReflectionLevel::rays;
    EXPECT_GT(red_on_the_ball(*frame_of(draft).layers), 30);
    EXPECT_TRUE(warnings_.empty());

    draft.scene.reflections = ReflectionLevel::plane;
    draft.scene.bounce = true;
    EXPECT_LT(red_on_the_ball(*frame_of(draft).layers), 10);
    EXPECT_FALSE(warnings_.empty()) << "light cannot bounce without rays";
}

TEST_F(NearLightTest, BouncedLightAloneCanBeLeftOut) {
    Shot shot = ball_and_lamp(QualityLevel::final_);
    shot.scene.bounce = false;
    EXPECT_EQ(with_choices_of(shot.scene, quality_of(QualityLevel::final_)).bounce.rays, 0);
    EXPECT_EQ(with_choices_of(shot.scene, quality_of(QualityLevel::final_)).reflection.level, ReflectionLevel::rays);
    shot.scene.bounce = true;
    EXPECT_EQ(with_choices_of(shot.scene, quality_of(QualityLevel::reference)).bounce.rays,
              quality_of(QualityLevel::reference).bounce.rays);
    EXPECT_EQ(with_choices_of(shot.scene, quality_of(QualityLevel::draft)).bounce.rays, BounceLightSettings{}.rays);
}

TEST_F(NearLightTest, WithoutObjectsRaysAreLeftOutAndNoBitChanges) {
    Shot shot = make_shot();
    shot.scene.objects.clear();
    shot.scene.quality = QualityLevel::final_;
    const CompositedFrame frame = with_layers(shot);
    EXPECT_TRUE(std::ranges::equal(frame.rgb16().samples(),
                                   grey_plate(320, 180, plate_luma_).rgb16({0, 0, 320, 180}).samples()));
    shot = make_shot();
    with_layers(shot);
    EXPECT_EQ(why_left_out("light/bounced"), "this quality level traces no rays");
}

TEST_F(NearLightTest, LeavingOutWhatIsNotNeededChangesNoBit) {
    const Shot shot = ball_and_lamp(QualityLevel::final_);
    const CompositedFrame lean = with_layers(shot, true), whole = with_layers(shot, false);
    EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole.rgb16().samples()));
}

}  // namespace
}  // namespace matchlight::test
