// What every call of the program keeps to: help, version, wrong calls, exit statuses.
#include <string>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

TEST(Program, VersionGoesToStandardOutput) {
    const RunResult result = run_matchlight({"--version"});
    EXPECT_TRUE(succeeded(result));
    EXPECT_EQ(result.standard_output, "matchlight " MATCHLIGHT_VERSION "\n");
    EXPECT_EQ(result.standard_error, "");
}

TEST(Program, HelpGoesToStandardOutputAndListsTheGlobalFlags) {
    const RunResult result = run_matchlight({"--help"});
    EXPECT_TRUE(succeeded(result));
    for (const char* word : {"--json", "--quiet", "--verbose", "--version"})
        EXPECT_NE(result.standard_output.find(word), std::string::npos) << word;
}

TEST(Program, NoCommandIsAWrongCall) {
    EXPECT_TRUE(refused_call(run_matchlight({})));
}

TEST(Program, UnknownCommandIsAWrongCall) {
    EXPECT_TRUE(refused_call(run_matchlight({"rendr"})));
}

TEST(Program, UnknownFlagIsAWrongCall) {
    EXPECT_TRUE(refused_call(run_matchlight({"--jsn"})));
}

TEST(Program, ClosedStandardInputIsNoObstacle) {
    RunOptions options;
    options.close_stdin = true;
    EXPECT_TRUE(succeeded(run_matchlight({"--version"}, options)));
}

}  // namespace
}  // namespace matchlight::test
