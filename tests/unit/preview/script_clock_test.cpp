// What a script is told of pictures that came, and when.
#include "preview/script_clock.h"

#include <thread>

#include <gmock/gmock.h>

namespace matchlight {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(ScriptClock, CountsPicturesSinceTheLastThingDone) {
    ScriptClock clock;
    clock.count(3);
    clock.settle();
    EXPECT_THAT(clock.told(), HasSubstr(", 3 pictures, the first after "));
    clock.begin(3);
    clock.settle();
    EXPECT_THAT(clock.told(), HasSubstr(", 0 pictures; "));
    clock.count(4);
    EXPECT_THAT(clock.told(), HasSubstr(", 1 pictures, the first after "));
}

TEST(ScriptClock, TellsARateOnlyWhileTheHandMoves) {
    ScriptClock clock;
    clock.begin(0);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    clock.count(2);
    EXPECT_THAT(clock.told(), Not(HasSubstr("a second")));
    clock.move();
    EXPECT_THAT(clock.told(), HasSubstr(" a second while the hand moved"));
}

TEST(ScriptClock, StartsWithTheProgramAndKnowsItsMemory) {
    // This test's program has run for a while, and holds some memory.
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    ScriptClock clock;
    clock.settle();
    EXPECT_THAT(clock.told(), StartsWith("settled after "));
    EXPECT_THAT(clock.told(), Not(StartsWith("settled after 0 ms")));
    EXPECT_THAT(clock.told(), Not(HasSubstr(" 0 MB")));
    EXPECT_THAT(clock.told(), HasSubstr(" MB of it allocated"));
}

}  // namespace
}  // namespace matchlight
