// matchlight doctor on this machine, and on one whose OpenGL is missing or too old.
#include <nlohmann/json.hpp>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

using nlohmann::json;

TEST(Doctor, ShowsWhatTheMachineHas) {
    const RunResult result = run_matchlight({"doctor"});
    EXPECT_TRUE(succeeded(result));
    for (const char* word : {"OpenGL", "renderer", "shaders", "encoders", "memory", "cores", "FFmpeg"})
        EXPECT_NE(result.standard_output.find(word), std::string::npos) << word;
}

TEST(Doctor, PrintsTheSameForPrograms) {
    const RunResult result = run_matchlight({"--json", "doctor"});
    ASSERT_TRUE(succeeded(result));
    const json found = json::parse(result.standard_output);
    EXPECT_EQ(found["matchlight"], MATCHLIGHT_VERSION);
    EXPECT_FALSE(found["gl"]["renderer"].get<std::string>().empty());
    EXPECT_GE(found["gl"]["max_texture_size"].get<int>(), 16384);  // OpenGL 4.5, table 23.53
    EXPECT_TRUE(found["gl"]["software"].is_boolean());
    // A rasteriser on the CPU has no GPU time to report.
    EXPECT_FALSE(found["gl"]["software"].get<bool>() && found["gl"]["timer_queries"].get<bool>());
    EXPECT_GT(found["memory"]["total_bytes"].get<std::uint64_t>(),
              found["memory"]["available_bytes"].get<std::uint64_t>());
    EXPECT_GE(found["cores"].get<int>(), 1);
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(found["shaders"].get<std::string>()) / "common"));
}

/// No driver for EGL to load, no display for GLFW.
RunOptions without_opengl() {
    RunOptions options;
    options.environment = {{"__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent"},
                           {"__EGL_VENDOR_LIBRARY_FILENAMES", ""},
                           {"DISPLAY", ""},
                           {"WAYLAND_DISPLAY", ""}};
    return options;
}

TEST(Doctor, FailsWhereThereIsNoOpenGlAndStillTellsTheRest) {
    const RunResult result = run_matchlight({"doctor"}, without_opengl());
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.standard_error.find("error: no OpenGL 4.5"), std::string::npos) << result.standard_error;
    EXPECT_NE(result.standard_output.find("encoders"), std::string::npos);

    const RunResult for_programs = run_matchlight({"--json", "doctor"}, without_opengl());
    EXPECT_EQ(for_programs.status, 1);
    EXPECT_TRUE(json::parse(for_programs.standard_output)["gl"].is_null());
}

TEST(Doctor, NamesAnOpenGlThatIsTooOld) {
    // Mesa lowers its version on request; other drivers have no such switch.
    const json here = json::parse(run_matchlight({"--json", "doctor"}).standard_output);
    if (here["gl"]["version"].get<std::string>().find("Mesa") == std::string::npos) {
        GTEST_SKIP() << "the driver is not Mesa's";
    }
    RunOptions options;
    options.environment = {{"MESA_GL_VERSION_OVERRIDE", "3.3"}, {"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
    const RunResult result = run_matchlight({"doctor"}, options);
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.standard_error.find("no OpenGL 4.5"), std::string::npos) << result.standard_error;
    EXPECT_NE(result.standard_error.find("OpenGL 3."), std::string::npos) << result.standard_error;
}

TEST(Doctor, SaysWhenTheShadersAreMissing) {
    RunOptions options;
    options.environment = {{"MATCHLIGHT_SHADERS", "/nonexistent/shaders"}};
    const RunResult result = run_matchlight({"doctor"}, options);
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.standard_error.find("/nonexistent/shaders"), std::string::npos) << result.standard_error;
}

}  // namespace
}  // namespace matchlight::test
