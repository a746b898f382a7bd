// A compositor that is given a changed scene draws what one made of that scene draws, bit for bit.
#include <algorithm>
#include <functional>
#include <ostream>

#include <gtest/gtest.h>

#include "ball_and_box.h"
#include "compositor/compositor.h"

namespace matchlight {
namespace {

struct Edit {
    const char* what;
    std::function<void(Scene&)> change;
};

void PrintTo(const Edit& edit, std::ostream* out) {
    *out << edit.what;
}

class EditedScene : public test::BallAndBox {
protected:
    void SetUp() override {
        set_up(160, 90);
        for (SolvedFrame& frame : solve_.frames) {
            frame.focus_distance_m = 0.6;
            frame.coc_scale_px_m = 10;
        }
        SolvedTag tag;
        tag.id = 0;
        tag.size_m = 0.08;
        tag.world_from_tag.translation() = Eigen::Vector3d(0.03, 0.02, 0);
        solve_.rig.push_back(tag);
    }

    static CompositorOptions options() {
        CompositorOptions options;
        options.settings = without_rays(coarse_quality());
        return options;
    }
    std::vector<std::uint16_t> frame_of(Compositor& compositor, std::int64_t frame = 0) const {
        const Image16 picture = compositor.composite(plate(frame)).rgb16();
        return {picture.samples().begin(), picture.samples().end()};
    }
    std::vector<std::uint16_t> made_afresh(const Scene& scene, std::int64_t frame = 0) {
        Compositor fresh(context(), scene, solve_, options(), warnings_);
        return frame_of(fresh, frame);
    }
};

/// The picture of the same compositor, given the change, which is that of one made of the changed scene.
class KindOfEdit : public EditedScene, public testing::WithParamInterface<Edit> {};

TEST_P(KindOfEdit, IsTakenAsByACompositorMadeOfIt) {
    Compositor compositor(context(), scene_, solve_, options(), warnings_);
    const auto before = frame_of(compositor);
    Scene edited = scene_;
    GetParam().change(edited);
    ASSERT_TRUE(compositor.set_scene(edited));
    const auto after = frame_of(compositor);
    EXPECT_FALSE(before == after);
    EXPECT_TRUE(after == made_afresh(edited));
    // And back, as undo does; coarse in between.
    EXPECT_TRUE(compositor.set_dragging(true));
    ASSERT_TRUE(compositor.set_scene(scene_));
    frame_of(compositor);
    EXPECT_TRUE(compositor.set_dragging(false));
    EXPECT_TRUE(frame_of(compositor) == before);
}

INSTANTIATE_TEST_SUITE_P(OfAScene, KindOfEdit,
                         testing::Values(Edit{"placement",
                                              [](Scene& scene) {
                                                  scene.objects[0].translate_m = {0, -0.04, 0.05};
                                                  scene.objects[1].scale.setConstant(0.04);
                                                  scene.objects[1].parent_tag = 0;
                                              }},
                                         Edit{"material",
                                              [](Scene& scene) {
                                                  scene.objects[0].material.metallic = 1;
                                                  scene.objects[0].material.roughness = 0;
                                                  scene.objects[1].material.base_color = {0.8, 0.1, 0.1};
                                                  scene.objects[1].material.specular = {0.2, 0.2, 0.2};
                                              }},
                                         Edit{"reflection_and_casting",
                                              [](Scene& scene) {
                                                  for (ObjectSettings& object : scene.objects)
                                                      object.reflection = ReflectionForm::sphere_map;
                                                  scene.objects[0].casts_shadow = false;
                                              }},
                                         Edit{"light",
                                              [](Scene& scene) {
                                                  scene.probe->placement = {.rotation_deg = 75, .exposure_ev = 0.5};
                                                  scene.probe->place_m = {0, 0, 0.1};
                                              }},
                                         Edit{"height_of_the_surface", [](Scene& scene) { scene.surface.z_m = 0.004; }},
                                         Edit{"no_shadow", [](Scene& scene) { scene.surface.shadow = false; }},
                                         Edit{"effects",
                                              [](Scene& scene) {
                                                  scene.effects.bloom.emplace().threshold = 0.1;
                                                  scene.effects.grain.emplace().read = 0.02;
                                                  scene.effects.vignette.emplace().v1 = -0.5;
                                              }},
                                         Edit{"lens",
                                              [](Scene& scene) {
                                                  DepthOfFieldSettings& lens = scene.effects.depth_of_field.emplace();
                                                  lens.focus_on = FocusTarget::object;
                                                  lens.focus_object = "cube";
                                                  lens.coc_scale_px_m = 20;
                                                  scene.objects[1].name = "cube";
                                                  scene.objects[0].focus = FocusOverride{};
                                              }}),
                         [](const auto& tested) { return std::string(tested.param.what); });

TEST_F(EditedScene, MovesOnWithObjectsThatMove) {
    scene_.objects[1].keys = {{.frame = 0, .translate_m = {0.02, 0, 0.03}, .scale = {0.05, 0.05, 0.05}},
                              {.frame = 1, .translate_m = {0, 0, 0.06}, .scale = {0.05, 0.05, 0.05}}};
    Compositor compositor(context(), scene_, solve_, options(), warnings_);
    frame_of(compositor, 1);
    Scene edited = scene_;
    edited.objects[0].translate_m.y() = 0.05;
    ASSERT_TRUE(compositor.set_scene(edited));
    EXPECT_TRUE(frame_of(compositor, 1) == made_afresh(edited, 1));
    EXPECT_TRUE(frame_of(compositor, 0) == made_afresh(edited, 0));
}

TEST_F(EditedScene, KeepsWhatItsChangeLeavesAlone) {
    CompositorOptions timed = options();
    timed.timed = true;
    Compositor compositor(context(), scene_, solve_, timed, warnings_);
    // A map that is made again takes another time.
    const auto made = [&](const std::string& pass) {
        frame_of(compositor);
        for (const PassReport& report : compositor.reports()) {
            if (report.name == pass) return report.why;
        }
        return std::string();
    };
    const std::string cube = made("light/reflection cube"), contact = made("shadow/contact");
    scene_.effects.bloom.emplace();
    scene_.objects[0].material.roughness = 0.2;
    ASSERT_TRUE(compositor.set_scene(scene_));
    EXPECT_EQ(made("shadow/contact"), contact);
    EXPECT_EQ(made("light/reflection cube"), cube);
}

TEST_F(EditedScene, DrawsNoObjectsAgainWhereOtherLightSpills) {
    scene_.effects.bloom.emplace().threshold = 0.1;
    Compositor compositor(context(), scene_, solve_, options(), warnings_);
    const auto objects_drawn = [&] {
        const std::vector<PassReport> reports = compositor.reports();
        return std::ranges::any_of(reports, [](const PassReport& pass) { return pass.name == "surface"; });
    };
    const auto before = frame_of(compositor);
    EXPECT_TRUE(objects_drawn());
    scene_.effects.bloom->strength *= 2;
    ASSERT_TRUE(compositor.set_scene(scene_));
    const auto brighter = frame_of(compositor);
    EXPECT_FALSE(objects_drawn());
    EXPECT_FALSE(brighter == before);
    EXPECT_TRUE(brighter == made_afresh(scene_));
    // And for another frame, or with another lens as well, they are.
    scene_.effects.bloom->strength *= 2;
    ASSERT_TRUE(compositor.set_scene(scene_));
    EXPECT_TRUE(frame_of(compositor, 1) == made_afresh(scene_, 1));
    EXPECT_TRUE(objects_drawn());
    scene_.effects.glare.emplace();
    scene_.effects.depth_of_field.emplace().focus_distance_m = 0.3;
    ASSERT_TRUE(compositor.set_scene(scene_));
    EXPECT_TRUE(frame_of(compositor, 1) == made_afresh(scene_, 1));
    EXPECT_TRUE(objects_drawn());
    scene_.effects.glare.reset();
    ASSERT_TRUE(compositor.set_scene(scene_));
    EXPECT_TRUE(frame_of(compositor, 1) == made_afresh(scene_, 1)) << "out of focus";
    EXPECT_FALSE(objects_drawn());
    frame_of(compositor, 1);
    EXPECT_TRUE(objects_drawn()) << "nothing changed: a frame that is drawn again is drawn";
}

TEST_F(EditedScene, HoldsShadowsWhileTheLightGetsBrighter) {
    Compositor compositor(context(), scene_, solve_, options(), warnings_);
    const auto before = frame_of(compositor);
    ASSERT_TRUE(compositor.set_dragging(true));
    scene_.probe->placement.exposure_ev += 1;
    ASSERT_TRUE(compositor.set_scene(scene_));
    EXPECT_FALSE(frame_of(compositor) == before);
    ASSERT_TRUE(compositor.set_dragging(false));
    EXPECT_TRUE(frame_of(compositor) == made_afresh(scene_));
}

TEST_F(EditedScene, NeedsAnotherPictureOfASurfaceThatMoved) {
    GatheredSurface gathered;
    gathered.radiance = ImageF(2, 2, 4, 0.5F);
    gathered.clipped = ImageF(2, 2, 1);
    gathered.rectangle_m = {Eigen::Vector2d(-0.2, -0.2), Eigen::Vector2d(0.2, 0.2)};
    CompositorOptions with = options();
    with.gathered_surface = std::make_shared<const GatheredSurface>(gathered);
    Compositor compositor(context(), scene_, solve_, with, warnings_);
    Scene edited = scene_;
    edited.objects[0].translate_m.z() = 0.06;
    EXPECT_TRUE(compositor.set_scene(edited));
    edited.surface.z_m = 0.01;
    EXPECT_TRUE(compositor.set_dragging(true));
    EXPECT_TRUE(compositor.set_scene(edited)) << "while it is dragged";
    EXPECT_FALSE(compositor.set_dragging(false));
    EXPECT_FALSE(compositor.set_scene(edited));
}

TEST_F(EditedScene, IsNotTakenWhereNothingCouldStay) {
    Compositor compositor(context(), scene_, solve_, options(), warnings_);
    const auto taken = [&](const std::function<void(Scene&)>& change) {
        Scene edited = scene_;
        change(edited);
        return compositor.set_scene(edited);
    };
    EXPECT_FALSE(taken([](Scene& scene) { scene.objects.pop_back(); }));
    EXPECT_FALSE(taken([](Scene& scene) { scene.objects[0].shape = "torus"; }));
    EXPECT_FALSE(taken([](Scene& scene) { scene.objects[0].holdout = true; }));
    EXPECT_FALSE(taken([](Scene& scene) { scene.quality = QualityLevel::draft; }));
    EXPECT_FALSE(taken([](Scene& scene) { scene.probe.reset(); }));
    EXPECT_FALSE(taken([](Scene& scene) { scene.footage.fps = 30; }));
}

}  // namespace
}  // namespace matchlight
