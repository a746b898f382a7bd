// `matchlight track --report`: the page of the sample shot's solve.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class SolvePageCommand : public CommandTest {
protected:
    void SetUp() override { shot_ = scratch_.copy_sample("table"); }

    RunResult track(const fs::path& report, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{
            "track", (shot_ / "table.toml").string(), "--level", "fast", "--report", report.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_matchlight(arguments);
    }

    fs::path shot_;
};

TEST_F(SolvePageCommand, ShowsTheSampleShot) {
    const RunResult result = track(scratch_ / "page", {"--json"});
    ASSERT_TRUE(succeeded(result));
    const fs::path page = scratch_ / "page" / "solve.html";
    EXPECT_EQ(nlohmann::json::parse(result.standard_output)["report"], page.string());
    const std::string html = bytes_of(page);
    EXPECT_TRUE(html.ends_with("</html>\n"));
    for (const char* part : {"Solve of table.toml", "id=\"flagged\"", "id=\"path\"", "id=\"residuals\"", "tag 3",
                             "exposure, EV", "622.222", "src=\"data:image/jpeg;base64,"}) {
        EXPECT_NE(html.find(part), std::string::npos) << part;
    }
    // The shot's exposure falls by half a stop about frame 6.
    EXPECT_NE(html.find("the exposure jumps"), std::string::npos);
    EXPECT_TRUE(fs::exists(shot_ / "table.solve.json"));
}

TEST_F(SolvePageCommand, DoesNotChangeTheSolve) {
    ASSERT_TRUE(succeeded(track(scratch_ / "page.html")));
    EXPECT_TRUE(fs::exists(scratch_ / "page.html"));
    const std::string with_page = bytes_of(shot_ / "table.solve.json");
    ASSERT_TRUE(succeeded(run_matchlight({"track", (shot_ / "table.toml").string(), "--level", "fast"})));
    EXPECT_EQ(bytes_of(shot_ / "table.solve.json"), with_page);
}

TEST_F(SolvePageCommand, ReplacesNothingUnlessTold) {
    const fs::path page = scratch_.write("page.html", "mine");
    EXPECT_TRUE(failed_naming(track(page), {"page.html", "--overwrite"}));
    EXPECT_EQ(bytes_of(page), "mine");
    EXPECT_FALSE(fs::exists(shot_ / "table.solve.json"));  // known before the long work
    EXPECT_TRUE(failed_naming(track(scratch_ / "no" / "such"), {"such"}));
    EXPECT_TRUE(succeeded(track(page, {"--overwrite"})));
    EXPECT_TRUE(bytes_of(page).starts_with("<!DOCTYPE html>"));
}

TEST_F(SolvePageCommand, ATrackThatFailsLeavesNoFolder) {
    fs::remove(shot_ / "plate.mp4");
    EXPECT_TRUE(failed_naming(track(scratch_ / "page"), {"plate.mp4"}));
    EXPECT_FALSE(fs::exists(scratch_ / "page"));
}

}  // namespace
}  // namespace matchlight::test
