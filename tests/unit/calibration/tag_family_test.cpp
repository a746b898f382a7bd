// Patterns of the families against known prints.
#include "calibration/tag_family.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

std::vector<std::string> drawn(const TagPattern& pattern) {
    std::vector<std::string> rows;
    for (int y = 0; y < pattern.cells; ++y) {
        std::string& row = rows.emplace_back();
        for (int x = 0; x < pattern.cells; ++x) {
            const TagPattern::Ink ink = pattern.at(x, y);
            row += ink == TagPattern::white ? '#' : (ink == TagPattern::black ? '.' : '?');
        }
    }
    return rows;
}

TEST(TagFamily, Tag36h11Id0LooksAsPublished) {
    const TagPattern pattern = TagFamily("tag36h11").pattern(0);
    EXPECT_EQ(pattern.border_begin, 1);
    EXPECT_EQ(pattern.border_end, 9);
    EXPECT_EQ(drawn(pattern),
              (std::vector<std::string>{"##########", "#........#", "#.##.#.#.#", "#..###.#.#", "#..##....#",
                                        "#.#.#....#", "#..#.##..#", "#....#...#", "#........#", "##########"}));
}

TEST(TagFamily, AReversedBorderHasItsWhiteInsideAndBitsOutside) {
    const TagPattern pattern = TagFamily("tagStandard41h12").pattern(0);
    EXPECT_EQ(pattern.border_begin, 2);
    EXPECT_EQ(pattern.border_end, 7);
    EXPECT_EQ(drawn(pattern), (std::vector<std::string>{"##.####..", ".........", "#.#####..", "..#####.#", "..#..##..",
                                                        "..#.#.#.#", "#.#####..", ".........", "##.#..#.."}));
}

TEST(TagFamily, CellsOutsideARoundTagAreUnknown) {
    const TagPattern pattern = TagFamily("tagCircle21h7").pattern(0);
    EXPECT_EQ(drawn(pattern), (std::vector<std::string>{"???#.#???", "?.......?", "?.#####.?", "..#.###..", "..#####.#",
                                                        "#.#.#.#.#", "?.#####.?", "?.......?", "???...???"}));
}

TEST(TagFamily, SmallFamiliesTolerateFewerWrongBits) {
    EXPECT_EQ(TagFamily("tag16h5").allowed_hamming(), 0);
    EXPECT_EQ(TagFamily("tagCircle21h7").allowed_hamming(), 1);
    EXPECT_EQ(TagFamily("tag36h11").allowed_hamming(), 2);
}

}  // namespace
}  // namespace matchlight
