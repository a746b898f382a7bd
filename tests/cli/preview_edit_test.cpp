// What is changed in the window is what its file says, and what render makes of that file.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>

#include "media/image_io.h"
#include "preview_window.h"

namespace matchlight::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class PreviewEditTest : public PreviewTest {
protected:
    /// Script lines that wait and then save the window's picture under a name.
    std::string shot(const std::string& name) const {
        return "wait_idle\nscreenshot " + (scratch_ / (name + ".png")).string() + "\n";
    }
    /// The scene's picture in that window, a pixel a pixel.
    Image8 picture(const std::string& name) const {
        return part_of(read_rgb8(scratch_ / (name + ".png")), whole_pixels_at);
    }
    std::string hand(const std::string& script) { return played(script, {"--size", "1280x720"}); }
};

TEST_F(PreviewEditTest, WhatIsSavedRendersAsTheWindowShowedIt) {
    append_to_scene("\n[effects]\nbloom = {strength = 0.6, threshold = 0.3} # as in the film\n");
    hand("wait_idle\nkey 1\n" + shot("first") +
         "show objects\nclick object[0]\nset object[0].translate \"0.02 0 0.01\"\n"
         "show light\nset light.exposure_ev 1.5\nset surface.shadow off\n" +
         shot("changed") + "key ctrl+z\nkey ctrl+z\nkey ctrl+z\n" + shot("undone") +
         "key ctrl+shift+z\nkey ctrl+shift+z\nkey ctrl+shift+z\n" + shot("redone") + "key b\n" + shot("without") +
         "key b\n" + shot("last") + "key ctrl+s\nwait_idle");
    EXPECT_FALSE(same(picture("changed"), picture("first")));
    EXPECT_TRUE(same(picture("undone"), picture("first")));
    EXPECT_TRUE(same(picture("redone"), picture("changed")));
    EXPECT_FALSE(same(picture("without"), picture("changed")));
    EXPECT_TRUE(same(picture("last"), picture("changed")));
    const std::string saved = bytes_of(scene_);
    for (const char* line : {"# A table that a camera circles", "translate = [0.02, 0, 0.01]", "exposure_ev = 1.5",
                             "shadow = false", "strength = 0.6, threshold = 0.3", "# as in the film"}) {
        EXPECT_THAT(saved, HasSubstr(line));
    }
    EXPECT_TRUE(same(rendered(0), picture("last")));
}

TEST_F(PreviewEditTest, SwitchesGoBackToWhatTheSceneHad) {
    append_to_scene("\n[effects.dazzle]\nstrength = 3\n");
    const std::string before = bytes_of(scene_);
    hand("wait_idle\nkey d\nwait_idle\nkey ctrl+s\nkey d\nkey x\nkey g\nwait_idle\nkey ctrl+s\nwait_idle");
    EXPECT_THAT(bytes_of(scene_), AllOf(HasSubstr("strength = 3"), HasSubstr("mode = \"simulated\""),
                                        HasSubstr("glare = \"auto\""), Not(HasSubstr("strength = 0"))));
}

TEST_F(PreviewEditTest, ShapesAreAddedAndRemoved) {
    const std::string printed = hand("wait_idle\nkey 1\n" + shot("first") + "show objects\nset add torus\n" +
                                     shot("added") + "controls\nclick remove\n" + shot("removed"));
    EXPECT_THAT(printed, HasSubstr("control object[1] "));
    EXPECT_FALSE(same(picture("added"), picture("first")));
    EXPECT_TRUE(same(picture("removed"), picture("first")));
}

TEST_F(PreviewEditTest, WhatTheSceneCannotHoldIsToldAndChangesNothing) {
    const std::string before = bytes_of(scene_);
    const std::string printed =
        hand("wait_idle\nshow light\nset light.probe none.exr\nwait_idle\nkey ctrl+s\nwait_idle");
    EXPECT_THAT(printed, HasSubstr("none.exr"));
    EXPECT_EQ(bytes_of(scene_), before);
}

}  // namespace
}  // namespace matchlight::test
