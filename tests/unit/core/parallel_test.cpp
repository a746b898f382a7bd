// Every index is visited once, and failures reach the caller.
#include "core/parallel.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
    std::vector<int> visits(1000, 0);
    parallel_for(1000, [&](int i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(1000, 1));
    parallel_for(0, [&](int) { FAIL(); });
}

TEST(Parallel, RethrowsTheFirstFailure) {
    EXPECT_THROW(parallel_for(100,
                              [](int i) {
                                  if (i == 57) throw std::runtime_error("57");
                              }),
                 std::runtime_error);
}

}  // namespace
}  // namespace matchlight
