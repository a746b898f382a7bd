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

TEST(Primaries, Aces2065IsThatOfOpenColorIO) {
    // "ACES2065-1 to Linear Rec.709" of OpenColorIO's ACES configs.
    Eigen::Matrix3d printed;
    printed << 2.521686, -1.134131, -0.387555, -0.276480, 1.372719, -0.096239, -0.015378, -0.152975, 1.168353;
    EXPECT_LT((rec709_from_aces2065() - printed).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(Primaries, AreGivenByAMatrixToo) {
    Eigen::Matrix3d matrix;
    matrix << 1.2, -0.1, -0.1, -0.05, 1.1, -0.05, 0, -0.2, 1.2;
    const Primaries given(matrix, "mine");
    EXPECT_EQ(rec709_from(given), matrix);
    EXPECT_TRUE((from_rec709(given) * matrix).isIdentity(1e-12));
    EXPECT_EQ(given.name(), "mine");
    EXPECT_FALSE(given == Primaries::rec709);
    EXPECT_TRUE(Primaries(Eigen::Matrix3d::Identity(), "the same") == Primaries::rec709);
}

}  // namespace
}  // namespace matchlight
