// Matrices against those that standards print.
#include "core/primaries.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(Primaries, AreThoseOfTheStandards) {
    // ITU-R BT.2087-0, table 2: Rec.2020 from Rec.709, to four decimals.
    Eigen::Matrix3d printed;
    printed << 0.6274, 0.3293, 0.0433, 0.0691, 0.9195, 0.0114, 0.0164, 0.0880, 0.8956;
    EXPECT_LT((from_rec709(Primaries::rec2020) - printed).cwiseAbs().maxCoeff(), 6e-5);
    EXPECT_TRUE(rec709_from(Primaries::rec709).isIdentity(0));
}

TEST(Primaries, KeepGreyAndInvert) {
    for (const Primaries primaries : {Primaries::rec709, Primaries::rec2020, Primaries::p3}) {
        EXPECT_TRUE((rec709_from(primaries) * Eigen::Vector3d::Ones()).isApprox(Eigen::Vector3d::Ones(), 1e-12));
        EXPECT_TRUE((rec709_from(primaries) * from_rec709(primaries)).isIdentity(1e-12));
    }
}

}  // namespace
}  // namespace matchlight
