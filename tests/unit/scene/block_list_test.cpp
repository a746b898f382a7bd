// A list in blocks keeps what was added, in one vector in the end.
#include "scene/block_list.h"

#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Numbers = BlockList<std::uint64_t>;
constexpr std::size_t several_blocks = 5 * Numbers::block_items / 2;

std::vector<std::uint64_t> counted(std::size_t count) {
    std::vector<std::uint64_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0U);
    return numbers;
}

TEST(BlockList, HoldsWhatWasAddedWhereverItBegan) {
    for (const std::size_t reserved : {std::size_t{0}, std::size_t{1000}, several_blocks}) {
        Numbers list;
        list.reserve(reserved);
        for (std::size_t i = 0; i < several_blocks; ++i) list.push_back(i);
        EXPECT_EQ(list.size(), several_blocks);
        list[several_blocks - 1] += 1;
        list[several_blocks - 1] -= 1;
        EXPECT_EQ(list.take(several_blocks), counted(several_blocks)) << reserved;
        EXPECT_EQ(list.size(), 0U);
    }
}

TEST(BlockList, GivesTheFirstOfItAlone) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, Numbers::block_items, Numbers::block_items + 1}) {
        Numbers list;
        for (std::size_t i = 0; i < several_blocks; ++i) list.push_back(i);
        EXPECT_EQ(list.take(count), counted(count)) << count;
    }
}

TEST(BlockList, IsFullWhereTheNextTakesMemory) {
    Numbers list;
    EXPECT_TRUE(list.is_full());
    list.push_back(0);
    EXPECT_FALSE(list.is_full());
    list.resize(Numbers::block_items, 7);
    EXPECT_TRUE(list.is_full());
    EXPECT_EQ(list[Numbers::block_items - 1], 7U);
}

}  // namespace
}  // namespace matchlight
