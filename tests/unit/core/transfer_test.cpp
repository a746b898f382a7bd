// Transfer functions against the values printed in their standards, and against their own inverses.
#include "core/transfer.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(Transfer, KnownValues) {
    EXPECT_NEAR(linear_from_srgb_code(0.5), 0.21404114, 1e-8);
    EXPECT_NEAR(pq_code_from_linear(0.01), 0.508078, 1e-5);   // 100 cd/m² (ST 2084)
    EXPECT_NEAR(hlg_code_from_linear(1.0 / 12), 0.5, 1e-12);  // BT.2100, table 5
    EXPECT_NEAR(hlg_code_from_linear(1.0), 1.0, 1e-7);
}

TEST(Transfer, PairsInvertEachOther) {
    for (int i = 0; i <= 1000; ++i) {
        const double x = i / 1000.0;
        EXPECT_NEAR(linear_from_srgb_code(srgb_code_from_linear(x)), x, 1e-7);
        EXPECT_NEAR(linear_from_pq_code(pq_code_from_linear(x)), x, 1e-9);
        EXPECT_NEAR(linear_from_hlg_code(hlg_code_from_linear(x)), x, 1e-9);
    }
}

TEST(Transfer, SrgbContinuesOutsideTheUnitRange) {
    EXPECT_NEAR(linear_from_srgb_code(srgb_code_from_linear(4.0)), 4.0, 1e-6);
    EXPECT_NEAR(linear_from_srgb_code(srgb_code_from_linear(-0.3)), -0.3, 1e-6);
}

}  // namespace
}  // namespace matchlight
