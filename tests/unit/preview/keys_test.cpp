// Key names, as --keys and the help have them.
#include "preview/keys.h"

#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

namespace matchlight {
namespace {

TEST(PreviewKeys, are_read_in_order) {
    using enum PreviewAction;
    EXPECT_THAT(actions_of_keys("b,right, right ,pagedown,escape"),
                testing::ElementsAre(bloom, step_on, step_on, ten_on, give_up));
    EXPECT_TRUE(actions_of_keys("").empty());
}

TEST(PreviewKeys, that_there_are_not_are_named) {
    for (const char* wrong : {"bb", "b,,g", "B", "b;g", ","}) {
        EXPECT_THROW(actions_of_keys(wrong), std::invalid_argument) << wrong;
    }
    try {
        actions_of_keys("b,rigth");
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("'rigth'"), testing::HasSubstr("right")));
    }
}

TEST(PreviewKeys, have_names_of_their_own_and_a_line_of_help) {
    std::set<std::string> names;
    for (const PreviewKey& key : preview_keys()) {
        EXPECT_TRUE(names.insert(key.name).second) << key.name;
        EXPECT_EQ(key.glfw_key == 0, key.name.substr(key.name.rfind('+') + 1).size() == 1) << key.name;
        EXPECT_EQ(action_of(event_of_key(key.name)), key.action) << key.name;
        EXPECT_THAT(preview_keys_text(), testing::HasSubstr(key.name + " "));
    }
}

TEST(PreviewKeys, ask_for_nothing_with_keys_of_the_desktop) {
    InputEvent event = event_of_key("b");
    event.control = true;
    EXPECT_EQ(action_of(event), std::nullopt);
    event = event_of_key("b");
    event.alt = true;
    EXPECT_EQ(action_of(event), std::nullopt);
    event = event_of_key("b");
    event.down = false;
    EXPECT_EQ(action_of(event), std::nullopt);
    event = event_of_key("b");
    event.repeated = true;
    EXPECT_EQ(action_of(event), std::nullopt);
    event = event_of_key("left");
    event.repeated = true;
    EXPECT_EQ(action_of(event), PreviewAction::step_back);
}

}  // namespace
}  // namespace matchlight
