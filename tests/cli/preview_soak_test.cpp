// The window's memory does not grow with use.
#include <algorithm>
#include <chrono>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "preview_window.h"

namespace matchlight::test {
namespace {

/// What is allocated, "…, 151.43 MB of it allocated" at the end of lines that begin with these words.
std::vector<double> allocated_mb(const std::string& printed, const std::string& words) {
    std::vector<double> all;
    std::istringstream lines(printed);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with(words)) continue;
        const std::size_t end = line.rfind(" MB of it allocated");
        all.push_back(std::stod(line.substr(line.rfind(' ', end - 1))));
    }
    return all;
}

// What is resident says little: it goes up and down by tens of MB with what the allocator keeps for later and where
// threads share its arenas, more so beside other work. What is allocated and not freed is the same after every round
// (to some 10 kB) where the software rasterizer has no threads of its own: those let go of textures sooner or later.
// Sanitizers have another allocator, of which nothing is told: there this is a test that nothing is wrong on the way.
TEST_F(PreviewTest, ItsMemoryDoesNotGrowWithUse) {
    const std::string round = bytes_of(fs::path(MATCHLIGHT_SOURCE_DIR) / "samples/table/soak.hand.txt");
    constexpr std::size_t rounds = 3;
    std::string script;
    for (std::size_t i = 0; i < rounds; ++i) script += round + "measure round\n";
    options_.environment["LP_NUM_THREADS"] = "0";
    options_.timeout = std::chrono::minutes(10);
    const std::vector<double> after_mb = allocated_mb(played(script, {"--size", "1280x720"}), "round: ");
    ASSERT_EQ(after_mb.size(), rounds);
    // The first round makes what stays. Were one picture of 640×360 kept in each of the others, both would grow by
    // 0.69 MB. The smaller of the two, as one of them may be made unlike the others by what ran beside it.
    EXPECT_LT(std::min(after_mb[1] - after_mb[0], after_mb[2] - after_mb[1]), 0.35) << testing::PrintToString(after_mb);
}

}  // namespace
}  // namespace matchlight::test
