// What a thread works on, told and given up.
#include "core/work.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/stop.h"

namespace matchlight {
namespace {

TEST(Work, IsToldAndGivenUpWithinItsScopeOnly) {
    Work work;
    tell_work("unheard", 1, 2);
    work.give_up();
    EXPECT_FALSE(work_is_given_up());
    EXPECT_NO_THROW(stop_if_given_up());
    {
        const WorkScope scope(work);
        tell_work("surface", 3, 12);
        EXPECT_TRUE(stop_requested());
        EXPECT_THROW(stop_if_given_up(), InputError);
    }
    EXPECT_FALSE(stop_requested());
    EXPECT_EQ(work.stage().name, "surface");
    EXPECT_EQ(work.stage().done, 3);
    EXPECT_EQ(work.stage().all, 12);
    work.begin();
    EXPECT_FALSE(work.is_given_up());
    EXPECT_EQ(work.stage().name, "");
}

TEST(Work, OfAnInnerScopeEndsWithIt) {
    Work outer, inner;
    const WorkScope scope(outer);
    {
        const WorkScope within(inner);
        inner.give_up();
        EXPECT_TRUE(work_is_given_up());
    }
    EXPECT_FALSE(work_is_given_up());
}

}  // namespace
}  // namespace matchlight
