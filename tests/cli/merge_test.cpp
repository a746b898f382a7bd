// matchlight merge, as a user runs it on photographs.
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/image.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class Merge : public CommandTest {
protected:
    /// An even picture of one code with a white square.
    fs::path photograph(const std::string& name, std::uint8_t code, int width = 32) const {
        Image8 picture(width, 24, 3, code);
        for (int y = 4; y < 8; ++y) {
            for (int x = 4; x < 8; ++x) std::fill_n(picture.pixel(x, y), 3, std::uint8_t{255});
        }
        const fs::path path = scratch_ / name;
        write_png8(path, picture);
        return path;
    }
};

TEST_F(Merge, WritesRadianceSigmaAndFlagsAndSaysWhatItDid) {
    const fs::path a = photograph("a.png", 188), b = photograph("b.png", 99), out = scratch_ / "out.exr";
    // sRGB: code 188 is 0.503 of full light, 99 is 0.125.
    const RunResult result =
        run_matchlight({"merge", a, b, "--times", "1/10,1/40", "--response", "srgb", "--json", "-o", out});
    ASSERT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"b.png", "16 of 768 pixels are clipped"}));
    const auto json = nlohmann::json::parse(result.standard_output);
    EXPECT_EQ(json["photographs"].size(), 2u);
    EXPECT_EQ(json["clipped_pixels"], 16);
    const double scale = json["exposure_scale"];
    const ImageF image = read_exr_part(
        out, "radiance", {"R", "G", "B", "sigma.R", "sigma.G", "sigma.B", "clipped", "under_noise", "ghost"});
    EXPECT_NEAR(image.at(20, 20, 0) / scale, 0.503 / 0.1, 0.03);
    EXPECT_GT(image.at(20, 20, 3), 0);
    EXPECT_EQ(image.at(20, 20, 6), 0);
    EXPECT_NEAR(image.at(5, 5, 0) / scale, 1 / 0.025, 0.5);
    EXPECT_EQ(image.at(5, 5, 6), 1);
}

TEST_F(Merge, TheOrderOfPhotographsChangesNothing) {
    const fs::path a = photograph("a.png", 188), b = photograph("b.png", 99), c = photograph("c.png", 30);
    ASSERT_TRUE(succeeded(run_matchlight({"merge", a, b, c, "--times", "0.1,0.025,0.003", "-o", scratch_ / "1.exr"})));
    ASSERT_TRUE(succeeded(run_matchlight({"merge", c, a, b, "--times", "0.003,0.1,0.025", "-o", scratch_ / "2.exr"})));
    EXPECT_EQ(bytes_of(scratch_ / "1.exr"), bytes_of(scratch_ / "2.exr"));
}

TEST_F(Merge, BadInputsAreNamed) {
    const fs::path a = photograph("a.png", 188), b = photograph("b.png", 99), wide = photograph("wide.png", 99, 40);
    const fs::path broken = scratch_.write("broken.png", "no picture"), out = scratch_ / "out.exr";
    struct Case {
        std::vector<std::string> arguments;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {{a, b}, {"a.png", "no exposure time", "--times"}},
        {{a, b, "--times", "1/10"}, {"1 exposure times for 2 photographs"}},
        {{a, b, "--times", "1/10,1/10"}, {"same exposure"}},
        {{a, b, "--times", "1/10,0"}, {"'0' is no exposure time"}},
        {{a, b, "--times", "1/10,soon"}, {"'soon' is no exposure time"}},
        {{a, a, "--times", "1/10,1/20"}, {"a.png", "given twice"}},
        {{a, wide, "--times", "1/10,1/20"}, {"wide.png", "40 × 24"}},
        {{a, broken, "--times", "1/10,1/20"}, {"broken.png"}},
        {{a, b, "--times", "1/10,1/20", "--response", "gamma=0"}, {"'gamma=0' is no response"}},
        {{a, b, "--times", "1/10,1/20", "--response", scratch_ / "none.json"}, {"none.json"}},
    };
    for (const Case& tried : cases) {
        std::vector<std::string> arguments = {"merge"};
        arguments.insert(arguments.end(), tried.arguments.begin(), tried.arguments.end());
        arguments.insert(arguments.end(), {"-o", out});
        EXPECT_TRUE(failed_naming(run_matchlight(arguments), tried.words));
        EXPECT_TRUE(nothing_left_of(out));
    }
    EXPECT_TRUE(failed_naming(run_matchlight({"merge", a, b, "--times", "1,2", "-o", scratch_ / "out.png"}),
                              {"out.png", ".exr"}));
    EXPECT_TRUE(refused_call(run_matchlight({"merge", a, b})));
}

TEST_F(Merge, ReplacesOnlyWhenAskedTo) {
    const fs::path a = photograph("a.png", 188), b = photograph("b.png", 99);
    const fs::path out = scratch_.write("out.exr", "mine");
    const std::vector<std::string> call = {"merge", a, b, "--times", "1/10,1/40", "-o", out};
    EXPECT_TRUE(failed_naming(run_matchlight(call), {"out.exr", "exists"}));
    EXPECT_EQ(bytes_of(out), "mine");
    auto again = call;
    again.emplace_back("--overwrite");
    EXPECT_TRUE(succeeded(run_matchlight(again)));
}

class MergeOfSharedData : public SharedDataTest {};

TEST_F(MergeOfSharedData, ReadsTimeAndFNumberAndFindsThemTrue) {
    std::vector<std::string> call = {"merge"};
    for (int i = 8; i >= 0; --i) call.push_back(data_ / "table" / "balls" / ("v0_b" + std::to_string(i) + ".jpg"));
    call.insert(call.end(), {"--json", "-o", scratch_ / "out.exr"});
    const RunResult result = run_matchlight(call);
    ASSERT_TRUE(succeeded(result));
    const auto json = nlohmann::json::parse(result.standard_output);
    const auto& photographs = json["photographs"];
    ASSERT_EQ(photographs.size(), 9u);
    // The last three are stopped down from f/8 to f/22.6.
    EXPECT_NEAR(photographs[8]["relative_ev"].get<double>() - photographs[0]["relative_ev"].get<double>(), -15, 0.001);
    int measured = 0;
    for (const auto& pair : json["pairs"]) {
        if (pair["samples"] == 0) continue;
        ++measured;
        const double sigma = pair["measured_sigma_ev"];
        EXPECT_NEAR(pair["measured_ev"].get<double>(), pair["recorded_ev"].get<double>(), 3 * sigma);
    }
    EXPECT_GE(measured, 4);
    EXPECT_EQ(json["clipped_pixels"], 0);
    EXPECT_LT(json["ghost_pixels"], 600);  // a thousandth: nothing moved
}

}  // namespace
}  // namespace matchlight::test
