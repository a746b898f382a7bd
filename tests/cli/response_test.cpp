// matchlight response, as a user runs it on photographs.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/image.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class ResponseCommand : public CommandTest {
protected:
    /// A slope of light in steps of 8 × 8 pixels, by a camera of gamma 1.8.
    fs::path photograph(const std::string& name, double exposure) const {
        Image8 picture(256, 192, 3);
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) {
                const int column = x / 8, row = y / 8;
                const double light = exposure * std::exp2(-(column * 0.25 + row * 0.03));
                const double code = std::pow(std::min(light, 1.0), 1 / 1.8);
                std::fill_n(picture.pixel(x, y), 3, static_cast<std::uint8_t>(std::lround(255 * code)));
            }
        }
        const fs::path path = scratch_ / name;
        write_png8(path, picture);
        return path;
    }
};

TEST_F(ResponseCommand, FindsTheCurveAndWritesWhatMergeReads) {
    const fs::path a = photograph("a.png", 4), b = photograph("b.png", 1), c = photograph("c.png", 0.25);
    const fs::path out = scratch_ / "response.json";
    const RunResult result = run_matchlight({"response", a, b, c, "--times", "1/15,1/60,1/240", "--json", "-o", out});
    ASSERT_TRUE(succeeded(result));
    const auto json = nlohmann::json::parse(result.standard_output);
    EXPECT_EQ(json["method"], "gamma");
    EXPECT_LT(json["residual_ev"].get<double>(), 0.02);
    const auto file = nlohmann::json::parse(read_text_file(out));
    EXPECT_EQ(file["family"], "gamma");
    for (const auto& exponent : file["gamma"]) EXPECT_NEAR(exponent.get<double>(), 1.8, 0.02);
    const std::string page = read_text_file(scratch_ / "response.html");
    EXPECT_THAT(page, testing::HasSubstr("<svg"));
    EXPECT_THAT(page, testing::HasSubstr("</html>"));
    EXPECT_EQ(page.find("nan"), std::string::npos);
    ASSERT_TRUE(succeeded(run_matchlight(
        {"merge", a, b, c, "--times", "1/15,1/60,1/240", "--response", out, "-o", scratch_ / "merged.exr"})));
    for (const char* method : {"debevec", "robertson", "srgb"}) {
        EXPECT_TRUE(succeeded(run_matchlight({"response", a, b, c, "--times", "1/15,1/60,1/240", "--method", method,
                                              "--no-report", "--overwrite", "-o", out})));
    }
}

TEST_F(ResponseCommand, WhatCannotTellIsRefused) {
    const fs::path a = photograph("a.png", 4), b = photograph("b.png", 1);
    const fs::path black = photograph("black.png", 0), dark = photograph("dark.png", 1e-9);
    const fs::path white = photograph("white.png", 1e9), glare = photograph("glare.png", 1e8);
    const fs::path out = scratch_ / "response.json";
    struct Case {
        std::vector<std::string> arguments;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {{{a, "--times", "1"}, {"a.png", "one photograph cannot tell"}},
                                     {{a, b, "--times", "1,1"}, {"same exposure"}},
                                     {{a, b}, {"no exposure time"}},
                                     {{black, dark, "--times", "1,2"}, {"cannot tell a response"}},
                                     {{white, glare, "--times", "1,2"}, {"cannot tell a response"}}};
    for (const Case& tried : cases) {
        std::vector<std::string> arguments = {"response"};
        arguments.insert(arguments.end(), tried.arguments.begin(), tried.arguments.end());
        arguments.insert(arguments.end(), {"-o", out});
        EXPECT_TRUE(failed_naming(run_matchlight(arguments), tried.words));
        EXPECT_TRUE(nothing_left_of(out));
        EXPECT_TRUE(nothing_left_of(scratch_ / "response.html"));
    }
}

class ResponseOfSharedData : public SharedDataTest {
protected:
    nlohmann::json response_of(std::vector<std::string> photographs,
                               const std::vector<std::string>& options = {}) const {
        photographs.insert(photographs.begin(), "response");
        photographs.insert(photographs.end(), options.begin(), options.end());
        photographs.insert(photographs.end(), {"--json", "--overwrite", "-o", scratch_ / "response.json"});
        const RunResult result = run_matchlight(photographs);
        EXPECT_TRUE(succeeded(result));
        return result.status == 0 ? nlohmann::json::parse(result.standard_output) : nlohmann::json();
    }
};

TEST_F(ResponseOfSharedData, ThePhotographsOfTheTablesBallAreSrgb) {
    for (const char* view : {"v0", "v1"}) {
        std::vector<std::string> photographs;
        for (int i = 0; i < 9; ++i)
            photographs.push_back(data_ / "table" / "balls" / (std::string(view) + "_b" + std::to_string(i) + ".jpg"));
        const auto json = response_of(photographs);
        EXPECT_EQ(json["method"], "srgb");
        EXPECT_LT(json["residual_ev"].get<double>(), 0.02);
    }
}

TEST_F(ResponseOfSharedData, ARealCamerasCurveMakesItsExposuresAgree) {
    std::vector<std::string> photographs;
    for (const char* name : {"raw1.jpg", "raw2.jpg", "raw3.jpg"})
        photographs.push_back(data_ / "real" / "brackets" / "olapietka_mirrorball" / name);
    response_of(photographs);
    photographs.insert(photographs.begin(), "merge");
    photographs.insert(photographs.end(),
                       {"--response", scratch_ / "response.json", "--json", "-o", scratch_ / "m.exr"});
    const RunResult result = run_matchlight(photographs);
    ASSERT_TRUE(succeeded(result));
    // With sRGB the two steps of 2 EV measure 2.6 and 3.0.
    for (const auto& pair : nlohmann::json::parse(result.standard_output)["pairs"])
        EXPECT_NEAR(pair["measured_ev"].get<double>(), 2, 0.05);
}

}  // namespace
}  // namespace matchlight::test
