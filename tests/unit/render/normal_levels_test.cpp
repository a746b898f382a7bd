// Levels of normals: means and deviations of what lies under a texel, against sums in double precision.
#include "render/normal_levels.h"

#include <array>
#include <cmath>
#include <random>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace matchlight {
namespace {

Eigen::Vector3d decoded(const std::uint8_t* code) {
    return Eigen::Vector3d(code[0], code[1], code[2]) / 127.5 - Eigen::Vector3d::Ones();
}

Image8 random_normals(int width, int height, double tilt) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> slope(-tilt, tilt);
    Image8 rgba(width, height, 4, 255);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d normal = Eigen::Vector3d(slope(random), slope(random), 1).normalized();
            for (int c = 0; c < 3; ++c)
                rgba.pixel(x, y)[c] = static_cast<std::uint8_t>(std::lround(127.5 * (normal[c] + 1)));
        }
    }
    return rgba;
}

TEST(NormalLevels, HoldTheMomentsOfWhatLiesUnderATexel) {
    const Image8 normals = random_normals(32, 32, 0.6);
    const std::vector<Image8> levels = normal_levels(normals);
    ASSERT_EQ(levels.size(), 6u);
    for (int level = 1; level < 6; ++level) {
        const int span = 1 << level;
        const Image8& coarse = levels[static_cast<std::size_t>(level)];
        ASSERT_EQ(coarse.width(), 32 / span);
        for (int i = 0; i < coarse.width(); ++i) {
            Eigen::Vector3d mean = Eigen::Vector3d::Zero();
            double square = 0;
            for (int y = 0; y < span; ++y) {
                for (int x = 0; x < span; ++x) {
                    const Eigen::Vector3d n = decoded(normals.pixel(span * i + x, span * i + y)).normalized();
                    mean += n / (span * span);
                    square += n.head<2>().squaredNorm() / (span * span);
                }
            }
            const double deviation = std::sqrt(square - mean.head<2>().squaredNorm());
            const std::uint8_t* code = coarse.pixel(i, i);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(code[c], 127.5 * (mean[c] + 1), 0.51);
            EXPECT_NEAR(code[3], 255 * deviation, 0.51);
        }
    }
}

TEST(NormalLevels, EvenMapsAreWidenedNowhere) {
    for (const std::uint8_t tilt : {0, 128, 200, 255}) {
        Image8 even(8, 8, 4, 255);
        for (int y = 0; y < 8; ++y) {
            for (int x = 0; x < 8; ++x) even.pixel(x, y)[0] = even.pixel(x, y)[1] = tilt;
        }
        for (const Image8& level : normal_levels(even)) {
            for (int y = 0; y < level.height(); ++y) {
                for (int x = 0; x < level.width(); ++x) EXPECT_EQ(level.pixel(x, y)[3], 0) << int{tilt};
            }
        }
    }
}

TEST(NormalLevels, TheFinestIsTheMapItself) {
    const Image8 normals = random_normals(7, 5, 1);
    const Image8 finest = normal_levels(normals).front();
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 7; ++x) {
            for (int c = 0; c < 3; ++c) EXPECT_EQ(finest.pixel(x, y)[c], normals.pixel(x, y)[c]);
            EXPECT_EQ(finest.pixel(x, y)[3], 0);
        }
    }
}

TEST(NormalLevels, AnySizeEndsInOneTexel) {
    for (const auto& [width, height, count] : {std::array{1, 1, 1}, {5, 3, 3}, {1, 9, 4}, {1000, 1, 10}}) {
        const std::vector<Image8> levels = normal_levels(random_normals(width, height, 0.3));
        ASSERT_EQ(levels.size(), static_cast<std::size_t>(count));
        for (std::size_t i = 1; i < levels.size(); ++i) {
            EXPECT_EQ(levels[i].width(), std::max(levels[i - 1].width() / 2, 1));
            EXPECT_EQ(levels[i].height(), std::max(levels[i - 1].height() / 2, 1));
        }
    }
    // A normal of no length points up.
    const Image8 none(2, 1, 4, 0);
    EXPECT_EQ(normal_levels(none).back().pixel(0, 0)[3], 0);
}

}  // namespace
}  // namespace matchlight
