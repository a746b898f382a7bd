// Where frames of controls differ, in a context of ImGui's without a window.
#include "preview/gui_damage.h"

#include <functional>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr Region window{0, 0, 400, 300};

class GuiDamageTest : public testing::Test {
protected:
    void SetUp() override {
        context_ = ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {static_cast<float>(window.width), static_cast<float>(window.height)};
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    }
    void TearDown() override { ImGui::DestroyContext(context_); }

    std::vector<Region> after(const std::function<void(ImDrawList&)>& draw) {
        ImGui::NewFrame();
        draw(*ImGui::GetBackgroundDrawList());
        ImGui::Render();
        return damage_.since_last(*ImGui::GetDrawData(), window);
    }
    std::vector<Region> after_words(const char* first, const char* second) {
        return after([&](ImDrawList& list) {
            list.AddRectFilled({10, 10}, {390, 290}, IM_COL32(40, 40, 40, 255));
            list.AddText({20, 20}, IM_COL32_WHITE, first);
            list.AddText({20, 200}, IM_COL32_WHITE, second);
        });
    }

    ImGuiContext* context_ = nullptr;
    GuiDamage damage_;
};

TEST_F(GuiDamageTest, TheFirstFrameIsAllNewAndTheSameOneAgainIsNot) {
    EXPECT_EQ(after_words("one", "two"), (std::vector<Region>{{9, 9, 382, 282}}));
    EXPECT_TRUE(after_words("one", "two").empty());
}

TEST_F(GuiDamageTest, WordsThatChangeAreNewWhereTheyStand) {
    after_words("one", "two");
    for (const char* second : {"six", "seven and more", "six", ""}) {
        const std::vector<Region> parts = after_words("one", second);
        ASSERT_EQ(parts.size(), 1u) << second;
        EXPECT_GE(parts[0].y, 195) << second;
        EXPECT_LE(parts[0].y + parts[0].height, 225) << second;
        EXPECT_GE(parts[0].x, 15) << second;
    }
}

TEST_F(GuiDamageTest, WhatMovesIsNewWhereItWasAndWhereItIs) {
    const auto square_at = [&](float x) {
        return after([&](ImDrawList& list) {
            list.AddRectFilled({x, 100}, {x + 10, 110}, IM_COL32_WHITE);
            list.AddRectFilled({300, 20}, {310, 30}, IM_COL32_WHITE);
        });
    };
    square_at(50);
    EXPECT_EQ(square_at(70), (std::vector<Region>{{49, 99, 32, 12}}));
}

TEST_F(GuiDamageTest, WhatIsCutOffOtherwiseIsNewWhole) {
    const auto cut_at = [&](float x) {
        return after([&](ImDrawList& list) {
            list.PushClipRect({0, 0}, {x, 300});
            list.AddRectFilled({50, 100}, {250, 110}, IM_COL32_WHITE);
            list.PopClipRect();
        });
    };
    cut_at(100);
    EXPECT_EQ(cut_at(200), (std::vector<Region>{{49, 99, 152, 12}}));
}

TEST_F(GuiDamageTest, WhatIsGoneIsNewWhereItWas) {
    after_words("one", "two");
    EXPECT_EQ(after([](ImDrawList&) {}), (std::vector<Region>{{9, 9, 382, 282}}));
}

TEST(RegionsApart, CoverAllAndDoNotOverlap) {
    EXPECT_TRUE(apart({}).empty());
    EXPECT_TRUE(apart({{5, 5, 0, 9}}).empty());
    const std::vector<Region> two{{0, 0, 10, 10}, {10, 0, 10, 10}};
    EXPECT_EQ(apart(two), two);
    // The third overlaps both, and with them the fourth.
    EXPECT_EQ(apart({{0, 0, 10, 10}, {20, 0, 10, 10}, {8, 5, 14, 30}, {0, 30, 2, 2}}),
              (std::vector<Region>{{0, 0, 30, 35}}));
}

}  // namespace
}  // namespace matchlight
