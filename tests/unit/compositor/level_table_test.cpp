// The choice of levels within a budget, and the file that costs are kept in.
#include "compositor/level_table.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "compositor/budget.h"
#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

LevelTable two_effects() {
    LevelTable table{"renderer", "version", {}};
    table.effects["surface"] = {{"draft", 2, 10, 0.01}, {"final", 4, 30, 0.004}, {"reference", 10, 200, 0}};
    table.effects["bloom"] = {{"draft", 1, 5, 0.02}, {"final", 1, 50, 0.001}};
    return table;
}
const std::vector<EffectLoad> both{{"surface", 0.5}, {"bloom", 1.0}};

TEST(ChooseLevels, TakesTheLeastErrorThatFits) {
    // draft + draft = 7 + 6 = 13 ms; final + draft 19 + 6 = 25; draft + final 7 + 51 = 58; final + final 70.
    EXPECT_EQ(choose_levels(two_effects(), both, 13).levels.at("surface"), "draft");
    const LevelChoice at_25 = choose_levels(two_effects(), both, 25);
    EXPECT_EQ(at_25.levels.at("surface"), "final");
    EXPECT_EQ(at_25.levels.at("bloom"), "draft");
    EXPECT_DOUBLE_EQ(at_25.predicted_ms, 25);
    EXPECT_DOUBLE_EQ(at_25.predicted_flip, 0.024);
    EXPECT_TRUE(at_25.within_budget);
    // Bloom's step is worth more than the surface's.
    const LevelChoice at_60 = choose_levels(two_effects(), both, 60);
    EXPECT_EQ(at_60.levels.at("surface"), "draft");
    EXPECT_EQ(at_60.levels.at("bloom"), "final");
    const LevelChoice rich = choose_levels(two_effects(), both, std::numeric_limits<double>::infinity());
    EXPECT_EQ(rich.levels.at("surface"), "reference");
    EXPECT_DOUBLE_EQ(rich.predicted_flip, 0.001);
}

TEST(ChooseLevels, MoreTimeNeverMeansMoreError) {
    double last = 1;
    for (double budget_ms = 1; budget_ms < 400; budget_ms += 1) {
        const LevelChoice choice = choose_levels(two_effects(), both, budget_ms);
        if (!choice.within_budget) continue;
        EXPECT_LE(choice.predicted_ms, budget_ms);
        EXPECT_LE(choice.predicted_flip, last) << budget_ms;
        last = choice.predicted_flip;
    }
    EXPECT_LT(last, 0.01);
}

TEST(ChooseLevels, TakesTheQuickestWhereNothingFits) {
    for (const double budget_ms : {0.0, 12.9, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        const LevelChoice choice = choose_levels(two_effects(), both, budget_ms);
        EXPECT_FALSE(choice.within_budget) << budget_ms;
        EXPECT_DOUBLE_EQ(choice.predicted_ms, 13);
    }
}

TEST(ChooseLevels, OfEqualErrorsTakesTheQuicker) {
    LevelTable table{"", "", {}};
    table.effects["surface"] = {{"slow", 9, 0, 0.1}, {"quick", 1, 0, 0.1}};
    EXPECT_EQ(choose_levels(table, std::vector<EffectLoad>{{"surface", 1}}, 100).levels.at("surface"), "quick");
}

TEST(ChooseLevels, LeavesAloneWhatTheTableDoesNotKnow) {
    const LevelChoice choice = choose_levels(two_effects(), std::vector<EffectLoad>{{"fog", 1}}, 10);
    EXPECT_TRUE(choice.levels.empty());
    EXPECT_TRUE(choice.within_budget);
    EXPECT_EQ(choice.predicted_ms, 0);
}

TEST(BudgetLoads, FollowWhatTheSceneHas) {
    FrameExtent extent{.object_megapixels = 0.1,
                       .reach_megapixels = 0.2,
                       .light = {100, 100, 200, 100},
                       .frame_width = 1000,
                       .frame_height = 500};
    EffectSettings effects;
    EXPECT_EQ(loads_of(effects, extent).size(), 2u);
    effects.bloom = BloomSettings{.radius = 0.04};
    const std::vector<EffectLoad> loads = loads_of(effects, extent);
    ASSERT_EQ(loads.size(), 3u);
    // Grown by 3 · 0.04 · 500 = 60 pixels on every side.
    EXPECT_DOUBLE_EQ(loads[2].megapixels, 320 * 220 / 1e6);
    effects.bloom->radius = 1;
    EXPECT_DOUBLE_EQ(loads_of(effects, extent)[2].megapixels, 0.5);
    effects.bloom->level = BloomLevel::classic;
    EXPECT_EQ(loads_of(effects, extent).size(), 2u);
    // Streaks of 4² steps, each a 128th of the frame's height: 62.5 pixels.
    effects.glare = GlareSettings{.passes = 2};
    const std::vector<EffectLoad> with_streaks = loads_of(effects, extent);
    ASSERT_EQ(with_streaks.size(), 3u);
    EXPECT_EQ(with_streaks[2].effect, "streaks");
    EXPECT_DOUBLE_EQ(with_streaks[2].megapixels, 326 * 226 / 1e6);
    effects.glare->level = GlareLevel::diffraction;
    EXPECT_EQ(loads_of(effects, extent).size(), 2u);
}

TEST(BudgetLoads, ChosenLevelsReplaceTheirOwnSettingsOnly) {
    LevelChoice choice;
    choice.levels = {{"surface", "draft"}, {"bloom", "reference"}, {"frame", "any"}};
    const Quality before = quality_of(QualityLevel::final_), after = with_levels(before, choice);
    EXPECT_EQ(after.supersampling, quality_of(QualityLevel::draft).supersampling);
    EXPECT_EQ(after.bloom, QualityLevel::reference);
    EXPECT_EQ(after.shadow.directions, before.shadow.directions);
    EXPECT_EQ(after.glare, before.glare);
    choice.levels["streaks"] = "draft";
    EXPECT_EQ(with_levels(before, choice).glare, QualityLevel::draft);
}

class LevelTableFile : public testing::Test {
protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "level_table_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        warnings_.set_quiet(true);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path path() const { return folder_ / "cache" / "matchlight" / "levels.json"; }

    fs::path folder_;
    Warnings warnings_;
};

TEST_F(LevelTableFile, KeepsOneTableForEachRendererAndVersion) {
    EXPECT_FALSE(load_level_table(path(), "renderer", "version", warnings_));
    LevelTable table = two_effects(), other = two_effects();
    other.gl_version = "another";
    save_level_table(path(), table, warnings_);
    save_level_table(path(), other, warnings_);
    table.effects["bloom"][1].ms_per_megapixel = 77;
    save_level_table(path(), table, warnings_);
    const auto read = load_level_table(path(), "renderer", "version", warnings_);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->effects.at("bloom")[1].ms_per_megapixel, 77);
    EXPECT_EQ(read->effects.at("surface")[2].level, "reference");
    EXPECT_EQ(load_level_table(path(), "renderer", "another", warnings_)->effects.at("bloom")[1].ms_per_megapixel, 50);
    EXPECT_FALSE(load_level_table(path(), "renderer", "third", warnings_));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(LevelTableFile, WarnsOfWhatItCannotRead) {
    fs::create_directories(path().parent_path());
    for (const char* text :
         {"", "{", "[]", "{\"matchlight_levels\": 99, \"machines\": []}",
          "{\"matchlight_levels\": 1, \"machines\": [{\"renderer\": 3}]}",
          "{\"matchlight_levels\": 1, \"machines\": [{\"renderer\": \"renderer\", \"gl_version\": \"version\","
          "\"effects\": {\"bloom\": [{\"level\": \"draft\", \"fixed_ms\": -1, \"ms_per_megapixel\": 1, "
          "\"flip\": 0}]}}]}"}) {
        std::ofstream(path(), std::ios::trunc) << text;
        Warnings warnings;
        warnings.set_quiet(true);
        EXPECT_FALSE(load_level_table(path(), "renderer", "version", warnings)) << text;
        ASSERT_EQ(warnings.total(), 1) << text;
        EXPECT_THAT(warnings.entries()[0].text, testing::HasSubstr("report --calibrate-machine"));
    }
    // Measuring again puts it right.
    save_level_table(path(), two_effects(), warnings_);
    EXPECT_TRUE(load_level_table(path(), "renderer", "version", warnings_));
}

TEST_F(LevelTableFile, SaysWhereItCannotBeWritten) {
    std::ofstream(folder_ / "cache") << "a file in the folder's place";
    EXPECT_THROW(save_level_table(path(), two_effects(), warnings_), InputError);
}

TEST(LevelTablePath, FollowsTheXdgSpecification) {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const std::string before = cache != nullptr ? cache : "";
    setenv("XDG_CACHE_HOME", "/somewhere", 1);
    EXPECT_EQ(level_table_path(), fs::path("/somewhere/matchlight/levels.json"));
    setenv("XDG_CACHE_HOME", "relative", 1);
    ASSERT_NE(std::getenv("HOME"), nullptr);
    EXPECT_EQ(level_table_path(), fs::path(std::getenv("HOME")) / ".cache/matchlight/levels.json");
    if (cache != nullptr) {
        setenv("XDG_CACHE_HOME", before.c_str(), 1);
    } else {
        unsetenv("XDG_CACHE_HOME");
    }
}

}  // namespace
}  // namespace matchlight
