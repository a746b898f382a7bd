// The test vectors of RFC 4648, section 10.
#include "core/base64.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

std::string coded(const std::string& text) {
    return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
}

TEST(Base64, GivesTheStandardsVectors) {
    EXPECT_EQ(coded(""), "");
    EXPECT_EQ(coded("f"), "Zg==");
    EXPECT_EQ(coded("fo"), "Zm8=");
    EXPECT_EQ(coded("foo"), "Zm9v");
    EXPECT_EQ(coded("foob"), "Zm9vYg==");
    EXPECT_EQ(coded("fooba"), "Zm9vYmE=");
    EXPECT_EQ(coded("foobar"), "Zm9vYmFy");
    EXPECT_EQ(coded("\xfb\xff\xfe"), "+//+");
}

}  // namespace
}  // namespace matchlight
