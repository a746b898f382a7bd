// The settings of bloom, glare and dazzling reflection: what a scene file says arrives, and what is out of range is
// refused, by the file's reader and by each struct's own check.
#include "scene/effects.h"

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "core/error.h"
#include "scene/scene_file.h"
#include "temporary_folder.h"

namespace matchlight {
namespace {

using testing::HasSubstr;

class EffectSettingsTest : public TemporaryFolder {
protected:
    void SetUp() override {
        TemporaryFolder::SetUp();
        warnings_.set_quiet(true);
        write("opening.png", "x");
    }
    EffectSettings load(const std::string& effects) {
        const Scene scene = load_scene(
            write("scene.toml", "[camera]\nwidth = 8\nheight = 6\norbit = {radius = 1}\n[effects]\n" + effects),
            warnings_);
        EXPECT_EQ(warnings_.total(), 0);
        effective_ = scene.effective_toml;
        return scene.effects;
    }
    std::string error_of(const std::string& effects) {
        try {
            load(effects);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }

    Warnings warnings_;
    std::string effective_;
};

TEST_F(EffectSettingsTest, AutoMeansTheDefaults) {
    const EffectSettings effects = load("bloom = \"auto\"\nglare = true\ndazzle = \"auto\"\n");
    ASSERT_TRUE(effects.bloom && effects.glare && effects.dazzle);
    EXPECT_EQ(effects.bloom->level, BloomLevel::pyramid);
    EXPECT_EQ(effects.bloom->radius, BloomSettings{}.radius);
    EXPECT_TRUE(effects.bloom->firefly_safe);
    EXPECT_EQ(effects.glare->level, GlareLevel::streaks);
    EXPECT_EQ(effects.glare->attenuation, GlareSettings{}.attenuation);
    EXPECT_EQ(effects.glare->passes, GlareSettings{}.passes);
    EXPECT_EQ(effects.dazzle->strength, DazzleSettings{}.strength);
    EXPECT_FALSE(effects.dazzle->glare);
    EXPECT_THAT(effective_, HasSubstr("attenuation = 0.92"));
    EXPECT_FALSE(load("bloom = \"off\"\nglare = false\n").glare);
}

TEST_F(EffectSettingsTest, EverySettingArrives) {
    const EffectSettings effects = load(R"(
dazzle = {strength = 2.5, glare = {directions = 2, angle_deg = 15, aperture = {blades = 5}}}
[effects.bloom]
level = "classic"
threshold = 3
knee = 0.25
strength = 0.5
radius = 0.1
firefly_safe = false
[effects.glare]
level = "diffraction"
threshold = 4
knee = 0
strength = 0.4
directions = 7
angle_deg = -30
attenuation = 0.5
passes = 2
halo = 0.1
[effects.glare.aperture]
blades = 9
rotation_deg = 5
roundness = 0.5
eyelashes = 3
dust = 2
image = "opening.png"
)");
    EXPECT_EQ(effects.bloom->level, BloomLevel::classic);
    EXPECT_EQ(effects.bloom->threshold, 3);
    EXPECT_EQ(effects.bloom->knee, 0.25);
    EXPECT_EQ(effects.bloom->strength, 0.5);
    EXPECT_EQ(effects.bloom->radius, 0.1);
    EXPECT_FALSE(effects.bloom->firefly_safe);
    EXPECT_EQ(effects.glare->level, GlareLevel::diffraction);
    EXPECT_EQ(effects.glare->threshold, 4);
    EXPECT_EQ(effects.glare->knee, 0);
    EXPECT_EQ(effects.glare->strength, 0.4);
    EXPECT_EQ(effects.glare->directions, 7);
    EXPECT_EQ(effects.glare->angle_deg, -30);
    EXPECT_EQ(effects.glare->attenuation, 0.5);
    EXPECT_EQ(effects.glare->passes, 2);
    EXPECT_EQ(effects.glare->halo, 0.1);
    EXPECT_EQ(effects.glare->aperture.blades, 9);
    EXPECT_EQ(effects.glare->aperture.rotation_deg, 5);
    EXPECT_EQ(effects.glare->aperture.roundness, 0.5);
    EXPECT_EQ(effects.glare->aperture.eyelashes, 3);
    EXPECT_EQ(effects.glare->aperture.dust, 2);
    EXPECT_EQ(effects.glare->aperture.image, folder_ / "opening.png");
    EXPECT_EQ(effects.dazzle->strength, 2.5);
    ASSERT_TRUE(effects.dazzle->glare);
    EXPECT_EQ(effects.dazzle->glare->directions, 2);
    EXPECT_EQ(effects.dazzle->glare->angle_deg, 15);
    EXPECT_EQ(effects.dazzle->glare->aperture.blades, 5);
    EXPECT_EQ(effects.dazzle->glare->threshold, GlareSettings{}.threshold);  // its own default, not the scene's glare
}

TEST_F(EffectSettingsTest, MistakesNameTheLine) {
    const std::vector<std::pair<std::string, std::string>> rows = {
        {"glare = {attenuation = 1}\n", "scene.toml:6: 'attenuation' in [effects.glare] is 1, outside its range"},
        {"glare = {attenuation = nan}\n", "not finite"},
        {"glare = {directions = 0}\n", "'directions' in [effects.glare] is 0"},
        {"glare = {directions = 2.5}\n", "'directions' in [effects.glare]"},
        {"glare = {passes = 6}\n", "'passes' in [effects.glare] is 6"},
        {"bloom = {radius = 0}\n", "'radius' in [effects.bloom] is 0"},
        {"bloom = {strength = -1}\n", "'strength' in [effects.bloom] is -1"},
        {"bloom = {level = \"piramid\"}\n", "did you mean 'pyramid'?"},
        {"bloom = \"on\"\n", "give \"off\", \"auto\" or a table of its settings"},
        {"dazzle = {glare = {aperture = {blades = 99}}}\n", "'blades' in [effects.dazzle.glare.aperture] is 99"},
        {"dazzle = {glare = {angle = 1}}\n", "unknown key 'angle' in [effects.dazzle.glare]"},
    };
    for (const auto& [effects, message] : rows) EXPECT_THAT(error_of(effects), HasSubstr(message)) << effects;
}

TEST(EffectSettings, ChecksRefuseWhatNoSceneFileMayHold) {
    const double not_a_number = std::numeric_limits<double>::quiet_NaN();
    BloomSettings bloom;
    EXPECT_NO_THROW(bloom.check());
    for (double* value : {&bloom.threshold, &bloom.knee, &bloom.strength, &bloom.radius}) {
        const double kept = *value;
        for (const double wrong : {-1.0, 1e7, not_a_number}) {
            *value = wrong;
            EXPECT_THROW(bloom.check(), std::invalid_argument);
        }
        *value = kept;
    }
    GlareSettings glare;
    EXPECT_NO_THROW(glare.check());
    for (double* value : {&glare.threshold, &glare.knee, &glare.strength, &glare.attenuation, &glare.halo}) {
        const double kept = *value;
        for (const double wrong : {-1.0, 1e7, not_a_number}) {
            *value = wrong;
            EXPECT_THROW(glare.check(), std::invalid_argument);
        }
        *value = kept;
    }
    DazzleSettings dazzle;
    dazzle.glare.emplace().directions = 0;
    EXPECT_THROW(dazzle.check(), std::invalid_argument);
}

TEST_F(EffectSettingsTest, SensorSettingsArrive) {
    const EffectSettings effects = load(R"(
grain = {read = 0.01, shot = 0.002, correlation_px = 0.7, strength = 0.5, seed = 9}
vignette = {v1 = -0.3, v2 = 0.1}
chromatic_aberration = {red_px = 1.5, blue_px = -0.5}
softness = {sigma_px = 0.6}
color_transform = {red_from = [0, 1, 0], model = "yiq", hue_deg = 30, saturation = 0.5, value = 1.5, contrast = -1, brightness = 0.1, grey = "average", tint = [1, 0.5, 0.25], fade = 0.75, fade_color = [0, 0, 1]}
repeated_blur = {passes = 4, radius_px = 3}
)");
    const ColorTransformSettings& color = *effects.color_transform;
    EXPECT_EQ(color.matrix[0], (std::array<double, 3>{0, 1, 0}));
    EXPECT_EQ(color.matrix[1], (std::array<double, 3>{0, 1, 0}));
    EXPECT_EQ(color.model, ColorModel::yiq);
    EXPECT_EQ(color.hue_deg, 30);
    EXPECT_EQ(color.saturation, 0.5);
    EXPECT_EQ(color.value, 1.5);
    EXPECT_EQ(color.contrast, -1);
    EXPECT_EQ(color.brightness, 0.1);
    EXPECT_EQ(color.grey, GreyKind::average);
    EXPECT_EQ(color.tint, (std::array<double, 3>{1, 0.5, 0.25}));
    EXPECT_EQ(color.fade, 0.75);
    EXPECT_EQ(color.fade_color, (std::array<double, 3>{0, 0, 1}));
    EXPECT_FALSE(color.is_identity());
    EXPECT_TRUE(ColorTransformSettings{}.is_identity());
    EXPECT_EQ(effects.repeated_blur->passes, 4);
    EXPECT_EQ(effects.repeated_blur->radius_px, 3);
    EXPECT_EQ(effects.grain->read, 0.01);
    EXPECT_EQ(effects.grain->shot, 0.002);
    EXPECT_EQ(effects.grain->correlation_px, 0.7);
    EXPECT_EQ(effects.grain->strength, 0.5);
    EXPECT_EQ(effects.grain->seed, 9);
    EXPECT_EQ(effects.vignette->v1, -0.3);
    EXPECT_EQ(effects.vignette->v2, 0.1);
    EXPECT_EQ(effects.chromatic_aberration->red_px, 1.5);
    EXPECT_EQ(effects.chromatic_aberration->blue_px, -0.5);
    EXPECT_EQ(effects.softness->sigma_px, 0.6);
}

TEST_F(EffectSettingsTest, TheVignetteAloneIsOnByItself) {
    const EffectSettings defaults = load("");
    EXPECT_TRUE(defaults.vignette && !defaults.vignette->v1 && !defaults.vignette->v2);
    EXPECT_FALSE(defaults.grain || defaults.chromatic_aberration || defaults.softness);
    EXPECT_FALSE(load("vignette = \"off\"\n").vignette);
    EXPECT_FALSE(load("vignette = false\n").vignette);
    EXPECT_TRUE(load("vignette = \"auto\"\ngrain = \"auto\"\n").vignette);
}

TEST_F(EffectSettingsTest, SensorSettingsOutOfRangeAreRefused) {
    for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
             {"grain = {read = -0.1}", "'read' in [effects.grain]"},
             {"grain = {shot = nan}", "'shot' in [effects.grain]"},
             {"grain = {shot = inf}", "'shot' in [effects.grain]"},
             {"grain = {correlation_px = 4.1}", "'correlation_px' in [effects.grain]"},
             {"grain = {seed = -1}", "'seed' in [effects.grain]"},
             {"grain = {seeed = 1}", "did you mean 'seed'?"},
             {"grain = 3", "\"off\", \"auto\" or a table"},
             {"vignette = {v1 = nan}", "'v1' in [effects.vignette]"},
             {"vignette = {v1 = -0.8, v2 = -0.4}", "turns light negative at r = 1"},
             {"vignette = {v1 = -1, v2 = 0.2}", "no error"},
             {"chromatic_aberration = {red_px = 101}", "'red_px' in [effects.chromatic_aberration]"},
             {"chromatic_aberration = {blue_px = nan}", "'blue_px' in [effects.chromatic_aberration]"},
             {"softness = {sigma_px = -1}", "'sigma_px' in [effects.softness]"},
             {"softness = {sigma_px = nan}", "'sigma_px' in [effects.softness]"},
             {"color_transform = {contrast = nan}", "'contrast' in [effects.color_transform]"},
             {"color_transform = {red_from = [1, 0]}", "'red_from' in [effects.color_transform]"},
             {"color_transform = {table = \"none.cube\"}", "none.cube"},
             {"color_transform = {grey = \"lab\"}", "'grey' in [effects.color_transform]"},
             {"repeated_blur = {passes = 0}", "'passes' in [effects.repeated_blur]"},
             {"repeated_blur = {radius_px = 33}", "'radius_px' in [effects.repeated_blur]"},
         }) {
        EXPECT_THAT(error_of(text + "\n"), HasSubstr(named)) << text;
    }
}

}  // namespace
}  // namespace matchlight
