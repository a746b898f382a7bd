#include "core/lowercase.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(Lowercase, ChangesLettersOfAsciiAlone) {
    EXPECT_EQ(lowercase("AZaz09_[@É\xff"), "azaz09_[@É\xff");
    EXPECT_EQ(lowercase(""), "");
}

TEST(Lowercase, ExtensionsAreThoseOfTheLastPart) {
    EXPECT_EQ(lowercase_extension("A.B/Shot.0001.EXR"), ".exr");
    EXPECT_EQ(lowercase_extension("A.B/shot"), "");
    EXPECT_EQ(lowercase_extension(".HIDDEN"), "");
}

}  // namespace
}  // namespace matchlight
