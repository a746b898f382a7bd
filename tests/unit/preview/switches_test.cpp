// What switches make of a scene's effects.
#include <gtest/gtest.h>

#include "preview/shot.h"

namespace matchlight {
namespace {

TEST(Switches, take_the_scenes_settings_where_it_has_them) {
    EffectSettings of_scene;
    of_scene.bloom.emplace().strength = 0.7;
    of_scene.glare.emplace().directions = 6;
    const EffectSettings effects = switched_effects(of_scene, {.bloom = true});
    ASSERT_TRUE(effects.bloom);
    EXPECT_EQ(effects.bloom->strength, 0.7);
    EXPECT_FALSE(effects.glare);
    EXPECT_EQ(switched_effects(of_scene, {.glare = true}).glare->directions, 6);
}

TEST(Switches, take_defaults_where_it_has_none) {
    const EffectSettings effects = switched_effects({}, {.bloom = true, .glare = true, .exposure = true});
    ASSERT_TRUE(effects.bloom && effects.glare && effects.exposure);
    EXPECT_EQ(effects.bloom->strength, BloomSettings{}.strength);
    EXPECT_EQ(effects.exposure->mode, ExposureMode::simulated);
}

TEST(Switches, leave_objects_out_of_what_spills) {
    EffectSettings of_scene;
    EXPECT_FALSE(switched_effects(of_scene, {.dazzle = true}).dazzle);
    of_scene.dazzle.emplace().strength = 3;
    EXPECT_EQ(switched_effects(of_scene, {.dazzle = true}).dazzle->strength, 3);
    EXPECT_EQ(switched_effects(of_scene, {}).dazzle->strength, 0);
}

TEST(Switches, between_matched_and_simulated_exposure) {
    EffectSettings of_scene;
    of_scene.exposure.emplace().key = 0.4;
    ASSERT_EQ(of_scene.exposure->mode, ExposureMode::matched);
    EXPECT_FALSE(switched_effects(of_scene, {}).exposure);
    const EffectSettings simulated = switched_effects(of_scene, {.exposure = true});
    EXPECT_EQ(simulated.exposure->mode, ExposureMode::simulated);
    EXPECT_EQ(simulated.exposure->key, 0.4);
}

}  // namespace
}  // namespace matchlight
