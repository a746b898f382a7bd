// The window's memory does not grow with use.
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "preview_window.h"

namespace matchlight::test {
namespace {

/// "…, 443 MB" at the end of lines that begin with these words.
std::vector<double> megabytes_of(const std::string& printed, const std::string& words) {
    std::vector<double> all;
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with(words)) continue;
        const std::size_t end = line.rfind(" MB");
        all.push_back(std::stod(line.substr(line.rfind(' ', end - 1))));
    }
    return all;
}

TEST_F(PreviewTest, ItsMemoryDoesNotGrowWithUse) {
    const std::string round = bytes_of(fs::path(MATCHLIGHT_SOURCE_DIR) / "samples/table/soak.hand.txt");
    constexpr int warm_up = 2, rounds = 7;
    std::string script;
    for (int i = 0; i < rounds; ++i) script += round + "measure round\n";
    const std::vector<double> used_mb = megabytes_of(played(script, {"--size", "1280x720"}), "round: ");
    ASSERT_EQ(used_mb.size(), std::size_t{rounds});
    // A round shows some twenty pictures of 0.7 MB, and makes maps of many: if one of these stayed each time, five
    // rounds would take 70 MB more. Without anything that stays they are 30 up and down (16 rounds measured).
    EXPECT_LT(used_mb.back() - used_mb[warm_up - 1], 50) << testing::PrintToString(used_mb);
}

}  // namespace
}  // namespace matchlight::test
