// What a scene's settings are: as written, and with what is left unsaid.
#include "preview/scene_values.h"

#include <gmock/gmock.h>

#include "core/warnings.h"
#include "scene/scene_edit.h"

namespace matchlight {
namespace {

using testing::ElementsAre;

TEST(SceneValues, are_the_files_and_defaults_where_it_says_nothing) {
    const SceneText text("scene.toml", R"([camera]
width = 64
height = 48
keys = [{frame = 0, eye = [0, -1, 1], target = [0, 0, 0]}]

[background]
color = [0.1, 0.2, 0.3]

[[object]]
shape = "sphere"
scale = 0.1

[effects]
bloom = {strength = 0.6, knee = 0.25, firefly_safe = false}
glare = "auto"
)");
    Warnings warnings;
    const SceneValues values(text, load_scene(text, warnings));
    EXPECT_EQ(values.number("effects.bloom.strength"), 0.6);
    EXPECT_GT(values.number("effects.bloom.radius"), 0);
    EXPECT_TRUE(values.is_table("effects.bloom"));
    EXPECT_FALSE(values.is_table("effects.glare"));
    EXPECT_EQ(values.written("effects.glare"), R"("auto")");
    EXPECT_EQ(values.written("effects.bloom"), R"({firefly_safe = false, knee = 0.25, strength = 0.6})");
    EXPECT_FALSE(values.is_written("effects.grain"));
    EXPECT_EQ(values.word("effects.grain"), "off");
    EXPECT_EQ(values.flag("object[0].casts_shadow"), true);
    EXPECT_THAT(values.numbers("object[0].scale"), ElementsAre(0.1));
    EXPECT_THAT(values.numbers("object[0].translate"), ElementsAre(0, 0, 0));
    EXPECT_THAT(values.numbers("background.color"), ElementsAre(0.1, 0.2, 0.3));
    EXPECT_EQ(values.number("object[1].scale"), std::nullopt);
}

}  // namespace
}  // namespace matchlight
