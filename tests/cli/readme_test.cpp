// The README is true: its scene reference is the program's own, and every command of its tour runs.
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "run_matchlight.h"
#include "scene/scene_file.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

std::string readme() {
    return bytes_of(fs::path(MATCHLIGHT_SOURCE_DIR) / "README.md");
}

/// The calls of `matchlight` in the shell blocks of the section "## A tour …", each as its arguments.
std::vector<std::vector<std::string>> calls_of_the_tour() {
    std::istringstream text(readme());
    std::vector<std::vector<std::string>> calls;
    bool in_tour = false;
    bool in_block = false;
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with("## ")) in_tour = line.starts_with("## A tour");
        if (line.starts_with("```")) in_block = line == "```sh";
        if (!in_tour || !in_block || !line.starts_with("matchlight ")) continue;
        std::istringstream words(line);
        std::string word;
        words >> word;  // the program's name
        std::vector<std::string> call;
        while (words >> word && word != "#") call.push_back(word);
        calls.push_back(call);
    }
    return calls;
}

TEST(Readme, LinksOnlyToWhatIsThere) {
    const std::string text = readme();
    const std::regex link(R"(\]\(([^)#:]+)\))");  // a colon would be of an address elsewhere
    int links = 0;
    for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found, ++links) {
        const std::string target = (*found)[1];
        EXPECT_TRUE(fs::exists(fs::path(MATCHLIGHT_SOURCE_DIR) / target)) << target;
    }
    EXPECT_GE(links, 4);
}

TEST(Readme, HoldsTheSceneReferenceOfTheProgram) {
    const std::string reference = scene_schema_text();
    if (readme().find(reference) != std::string::npos) return;
    const fs::path copy = fs::temp_directory_path() / "matchlight_scene_reference.md";
    std::ofstream(copy) << reference;
    FAIL() << "the section \"Scene file\" of README.md is not what the program says; it belongs there as in " << copy;
}

TEST_F(CommandTest, EveryCommandOfTheTourRuns) {
    scratch_.copy_sample("table");
    fs::create_directories(scratch_ / "samples");
    fs::rename(scratch_ / "table", scratch_ / "samples" / "table");
    RunOptions options;
    options.working_directory = scratch_.path();
    const std::vector<std::vector<std::string>> calls = calls_of_the_tour();
    EXPECT_GE(calls.size(), 8u);
    for (const std::vector<std::string>& call : calls) {
        const RunResult result = run_matchlight(call, options);
        EXPECT_TRUE(succeeded(result)) << call.front();
        // What a small machine has to spare, with the software rasteriser's own needs.
        EXPECT_LT(result.peak_memory_bytes, std::int64_t{1} << 30) << call.front();
    }
    for (const char* made : {"tour.mp4", "tour_000.png", "tour_006.exr", "tour_ball.exr"})
        EXPECT_TRUE(fs::exists(scratch_ / made)) << made;
}

}  // namespace
}  // namespace matchlight::test
