// matchlight lens: the figures of a lens by its own data, of a scene's camera, and what it refuses.
#include <nlohmann/json.hpp>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

using nlohmann::json;

TEST(Lens, TellsWhatIsSharp) {
    const RunResult result = run_matchlight({"--json", "lens", "--focal-mm", "50", "--f-number", "2", "--focus-m",
                                             "1.5", "--width", "3600", "--coc-px", "3", "--at", "1.5", "3", "inf"});
    ASSERT_TRUE(succeeded(result));
    const json found = json::parse(result.standard_output);
    EXPECT_NEAR(found["hyperfocal_m"], 0.05 * 0.05 / (2 * 3e-5) + 0.05, 1e-9);
    EXPECT_NEAR(found["focal_px"], 0.05 * 1.5 / (1.5 - 0.05) / 1e-5, 1e-6);
    EXPECT_NEAR(found["at"][0]["coc_px"], 0, 1e-9);
    EXPECT_NEAR(found["at"][2]["coc_px"], 0.05 * 0.05 / 2 / 1.45 / 1e-5, 1e-6);
    EXPECT_LT(found["near_m"], 1.5);
    EXPECT_GT(found["far_m"], 1.5);
}

using LensTest = CommandTest;

TEST_F(LensTest, ReadsTheCameraOfAScene) {
    const auto scene = scratch_.write("s.toml",
                                      "[camera]\nwidth = 640\nheight = 360\nframes = 2\nvertical_fov_deg = 32\n"
                                      "orbit = {radius = 1}\nlens = {f_number = 2.8, focus_distance_m = 0.6}\n"
                                      "[[object]]\nshape = \"sphere\"\n");
    const RunResult result = run_matchlight({"--json", "lens", scene.string(), "--frame", "1"});
    ASSERT_TRUE(succeeded(result));
    const json found = json::parse(result.standard_output);
    EXPECT_NEAR(found["focus_distance_m"], 0.6, 1e-12);
    EXPECT_EQ(found["frame"], 1);
}

TEST(Lens, RefusesWhatNoLensCanDo) {
    const std::vector<std::vector<std::string>> calls = {
        {"lens"},
        {"lens", "--focal-mm", "50", "--f-number", "0"},
        {"lens", "--focal-mm", "50", "--f-number", "nan"},
        {"lens", "--focal-mm", "50", "--f-number", "2", "--focus-m", "0.05"},
        {"lens", "--focal-mm", "50", "--f-number", "2", "--focus-m", "-1"},
        {"lens", "--focal-mm", "50", "--f-number", "2", "--at", "0"},
        {"lens", "--focal-mm", "50", "--f-number", "2", "--coc-px", "0"},
        {"lens", "--focal-mm", "50", "--f-number", "2", "--sensor-mm", "inf"},
        {"lens", "nothing.solve.json"}};
    for (const auto& call : calls) {
        const RunResult result = run_matchlight(call);
        EXPECT_EQ(result.status, 1) << result.standard_output;
        EXPECT_EQ(result.standard_error.find("error: "), 0U) << result.standard_error;
    }
}

}  // namespace
}  // namespace matchlight::test
