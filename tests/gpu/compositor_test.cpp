// The compositor as a whole: what it leaves out of a frame changes no bit of it.
#include "compositor/compositor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string_view>
#include <vector>

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

/// Noise of one sample over the standard deviation that the model says is missing there.
struct GrainSample {
    double light = 0, normalised = 0;
};
struct GrainSeen {
    std::vector<GrainSample> objects, shadows;
    int untouched_changed = 0;
};

GrainSeen seen_grain(const FrameLayers& plain, const FrameLayers& grainy, const ImageF& plate,
                     const GrainSettings& settings) {
    GrainSeen seen;
    const auto variance = [&](double light) {
        return *settings.read * *settings.read + *settings.shot * std::min(light, 1.0);
    };
    const Region both = plain.region.intersected(grainy.region);
    for (int y = both.y; y < both.y + both.height; ++y) {
        for (int x = both.x; x < both.x + both.width; ++x) {
            const int px = x - plain.region.x, py = y - plain.region.y;
            const double alpha = plain.alpha.at(px, py);
            for (int c = 0; c < 3; ++c) {
                const double light = plain.beauty.at(px, py, c), ratio = plain.shadow.at(px, py, c);
                const double noise = grainy.beauty.at(x - grainy.region.x, y - grainy.region.y, c) - light;
                const double kept = ratio * (1 - alpha);
                if (kept == 1) {
                    seen.untouched_changed += noise != 0;
                    continue;
                }
                const double missing = variance(light) - kept * kept * variance(plate.at(x, y, c));
                // Four deviations below, so that noise never meets black; and none so small that it counts as none.
                if (light < 4 * std::sqrt(variance(light)) || missing < 1e-7) continue;
                const GrainSample sample{light, noise / std::sqrt(missing)};
                if (alpha > 0.999) seen.objects.push_back(sample);
                if (alpha == 0) seen.shadows.push_back(sample);
            }
        }
    }
    return seen;
}

/// The variance is 1, to four standard errors.
void expect_unit_variance(std::span<const GrainSample> samples, const char* what) {
    double sum = 0;
    for (const GrainSample& sample : samples) sum += sample.normalised * sample.normalised;
    const double count = static_cast<double>(samples.size());
    EXPECT_NEAR(sum / count, 1, 4 * std::sqrt(2 / count)) << what << ", " << count;
}

TEST_F(CompositorTest, GrainFillsUpToTheModelsVariance) {
    Shot shot = make_shot();
    shot.scene.objects[0].scale.setConstant(0.12);
    shot.scene.objects[0].material.metallic = 0;
    shot.scene.objects[0].material.roughness = 1;
    Warnings warnings;
    warnings.set_quiet(true);
    const auto layers_of = [&](ImageF& plate_linear) {
        const PlateFrame plate = test::grey_plate(320, 180, plate_luma_);
        Compositor compositor(context(), shot.scene, shot.solve, {.quality = QualityLevel::draft, .layers = true},
                              warnings);
        plate_linear = compositor.plate_linear(plate);
        return *compositor.composite(plate).layers;
    };
    ImageF plate;
    const FrameLayers plain = layers_of(plate);
    shot.scene.effects.grain = GrainSettings{.read = 0.003, .shot = 2e-4, .correlation_px = 0.0};
    GrainSeen seen = seen_grain(plain, layers_of(plate), plate, *shot.scene.effects.grain);
    EXPECT_EQ(seen.untouched_changed, 0);
    ASSERT_GT(seen.objects.size(), 5'000U);
    ASSERT_GT(seen.shadows.size(), 2'000U);
    std::ranges::sort(seen.objects, {}, &GrainSample::light);
    const std::span<const GrainSample> objects = seen.objects;
    const std::size_t half = objects.size() / 2;
    expect_unit_variance(objects.first(half), "the darker half of the object");
    expect_unit_variance(objects.subspan(half), "the brighter half");
    expect_unit_variance(seen.shadows, "shadow");
    EXPECT_GT(objects[half + half / 2].light, 1.25 * objects[half / 2].light) << "more than one level of light";
}

TEST_F(CompositorTest, GrainIsTheSameOnceAgainAndInEveryWayOfDrawing) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.grain = GrainSettings{.read = 0.01, .shot = 1e-3, .correlation_px = 0.6};
    const CompositedFrame grainy = composite(shot, true);
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), grainy.rgb16().samples()));
    EXPECT_EQ(std::ranges::count(plain.touched.samples(), 255), std::ranges::count(grainy.touched.samples(), 255));
    EXPECT_TRUE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, true).rgb16().samples()));
    EXPECT_TRUE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, false).rgb16().samples()));
    // With effects of bright light, of which there is none, the noise comes in another pass.
    shot.scene.effects.bloom = BloomSettings{.threshold = 1e5};
    EXPECT_TRUE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, true).rgb16().samples()));
    shot.scene.effects.bloom.reset();
    shot.scene.effects.grain->seed = 2;
    EXPECT_FALSE(std::ranges::equal(grainy.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

TEST_F(CompositorTest, GrainThatNobodySees) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    for (const GrainSettings& none :
         {GrainSettings{.read = 0, .shot = 0}, GrainSettings{.read = 1e-5, .shot = 1e-12, .correlation_px = 1.0},
          GrainSettings{.read = 0.1, .shot = 0.1, .strength = 0}}) {
        shot.scene.effects.grain = none;
        expect_same_without(shot, "grain/white");
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    }
    // Neither scene nor solve knows the noise.
    shot.scene.effects.grain = GrainSettings{};
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    shot.solve.noise = {0.01, 1e-3};
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

TEST_F(CompositorTest, TheVignetteIsTheSolvesUnlessSetOrOff) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.solve.vignette = {-0.9, 0.1};
    const CompositedFrame solved = composite(shot, true);
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), solved.rgb16().samples()));
    shot.scene.effects.vignette.reset();
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    shot.solve.vignette.reset();
    shot.scene.effects.vignette = VignetteSettings{.v1 = -0.9, .v2 = 0.1};
    EXPECT_TRUE(std::ranges::equal(solved.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

/// A black ball before a white plate, left of the middle.
Shot black_ball() {
    Shot shot = make_shot();
    shot.scene.surface.shadow = false;
    ObjectSettings& ball = shot.scene.objects[0];
    ball.translate_m.x() = -0.16;
    ball.scale.setConstant(0.08);
    ball.material.metallic = 0;
    ball.material.roughness = 1;
    ball.material.base_color = {0, 0, 0};
    shot.solve.frames[0].exposure_ev = -20;
    return shot;
}

TEST_F(CompositorTest, ABlackObjectBeforeAWhitePlateHasColouredFringes) {
    plate_luma_ = 235;
    Shot shot = black_ball();
    const Image8 plain = composite(shot, true).rgb8();
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 4, .blue_px = -4};
    const CompositedFrame fringed = composite(shot, true);
    EXPECT_TRUE(was_drawn("chromatic aberration"));
    EXPECT_TRUE(std::ranges::equal(fringed.rgb16().samples(), composite(shot, false).rgb16().samples()));
    const Image8 after = fringed.rgb8();
    std::array<double, 3> dark{}, moved{};
    int cyan = 0, yellow = 0;
    for (int y = 0; y < 180; ++y) {
        for (int x = 0; x < 320; ++x) {
            const auto lost = [&](int c) { return 255.0 - after.at(x, y, c); };
            for (int c = 0; c < 3; ++c) {
                dark[static_cast<std::size_t>(c)] += lost(c);
                moved[static_cast<std::size_t>(c)] += x * lost(c);
            }
            ASSERT_EQ(after.at(x, y, 1), plain.at(x, y, 1)) << "green stays";
            cyan += after.at(x, y, 0) < 60 && after.at(x, y, 2) > 200;
            yellow += after.at(x, y, 0) > 200 && after.at(x, y, 2) < 60;
        }
    }
    EXPECT_GT(cyan, 20);
    EXPECT_GT(yellow, 20);
    // Left of the middle red moves to the left, blue to the right, by 4 px · r / r of the corner: at 85 of 184 px.
    EXPECT_NEAR(moved[0] / dark[0] - moved[1] / dark[1], -1.85, 0.2);
    EXPECT_NEAR(moved[2] / dark[2] - moved[1] / dark[1], 1.85, 0.2);
}

TEST_F(CompositorTest, ChromaticAberrationUnderAQuarterPixel) {
    Shot shot = make_shot();
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 0.24, .blue_px = -0.24};
    expect_same_without(shot, "chromatic aberration");
    // More in the corners, but the ball is in the middle.
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 0.5, .blue_px = {}};
    expect_same_without(shot, "chromatic aberration");
    // Nobody says how much.
    const CompositedFrame plain = composite(make_shot(), true);
    shot.scene.effects.chromatic_aberration = ChromaticAberrationSettings{};
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

TEST_F(CompositorTest, SoftnessIsTheSolvesOrSetOrNone) {
    Shot shot = make_shot();
    const CompositedFrame plain = composite(shot, true);
    shot.scene.effects.softness = SoftnessSettings{};
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    for (const double sigma_px : {0.0, 0.1, 0.199}) {
        shot.scene.effects.softness->sigma_px = sigma_px;
        expect_same_without(shot, "softness/across");
        EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), composite(shot, true).rgb16().samples()));
    }
    shot.scene.effects.softness->sigma_px.reset();
    shot.solve.softness_px = 0.8;
    const CompositedFrame solved = composite(shot, true);
    EXPECT_FALSE(std::ranges::equal(plain.rgb16().samples(), solved.rgb16().samples()));
    EXPECT_TRUE(std::ranges::equal(solved.rgb16().samples(), composite(shot, false).rgb16().samples()));
    shot.solve.softness_px.reset();
    shot.scene.effects.softness->sigma_px = 0.8;
    EXPECT_TRUE(std::ranges::equal(solved.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

}  // namespace
}  // namespace matchlight
