// Recovery of known focus, aperture and shutter from readings with noise of known size.
#include "tracking/optics_solve.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tracking/blur_kernel.h"

namespace matchlight {
namespace {

struct OpticsCase {
    std::size_t frames = 12;
    double coc_scale = 8, shutter = 0, softness_px2 = 0.2;
    std::function<double(std::size_t)> focus_m = [](std::size_t) { return 0.6; };
    double nearest_m = 0.5, farthest_m = 0.75;
    Eigen::Vector2d motion_px = Eigen::Vector2d::Zero();  // amplitude of a swing
    double noise_px2 = 0.02;
    double unevenness_px2 = 0;  // of softness, from one tag's place to another's
    unsigned seed = 1;
};

/// Four tags of four strips between the nearest and the farthest depth, seen by a camera that swings.
std::vector<TagBlurReadings> readings_of(const OpticsCase& clip) {
    std::mt19937 random(clip.seed);
    std::normal_distribution<double> normal;
    constexpr int tags = 4, strips = 4;
    double uneven[tags][2 * strips];
    for (auto& tag : uneven) {
        for (double& place : tag) place = clip.unevenness_px2 * normal(random);
    }
    std::vector<TagBlurReadings> all;
    for (std::size_t t = 0; t < clip.frames; ++t) {
        const double phase = 0.3 * static_cast<double>(t);
        const Eigen::Vector2d motion(clip.motion_px.x() * std::cos(phase), clip.motion_px.y() * std::sin(1.3 * phase));
        for (int id = 0; id < tags; ++id) {
            TagBlurReadings tag;
            tag.frame = t;
            tag.id = id;
            tag.covariance = Eigen::MatrixXd::Identity(2 * strips, 2 * strips) * std::pow(clip.noise_px2, 2);
            for (int i = 0; i < 2 * strips; ++i) {
                const double share = (id + 0.25 * (i % strips)) / (tags - 0.25);
                BlurReading reading;
                reading.inverse_depth = 1 / (clip.nearest_m + share * (clip.farthest_m - clip.nearest_m));
                reading.place = {0.2 + 0.2 * id + 0.01 * (i % strips), 0.4 - 0.2 * share};
                const double angle = 0.4 * id + (i < strips ? 0 : 1.5);
                reading.normal = {std::cos(angle), std::sin(angle)};
                reading.motion_px = motion.dot(reading.normal);
                EdgeKernel kernel;
                kernel.normal = reading.normal;
                kernel.disc = std::pow(clip.coc_scale * (1 / clip.focus_m(t) - reading.inverse_depth), 2) / 16;
                kernel.motion = std::pow(clip.shutter * reading.motion_px, 2) / 12;
                kernel.gaussian = clip.softness_px2 + uneven[id][i];
                reading.variance_px2 = fitted_variance(kernel).value + clip.noise_px2 * normal(random);
                tag.readings.push_back(reading);
            }
            all.push_back(std::move(tag));
        }
    }
    return all;
}

double worst_focus_error(const OpticsCase& clip, const OpticsSolution& optics) {
    double worst = 0;
    for (std::size_t t = 0; t < clip.frames; ++t) {
        worst = std::max(worst, std::abs(1 / optics.focus[t].value / clip.focus_m(t) - 1));
    }
    return worst;
}

class FocusDistances : public testing::TestWithParam<double> {};

TEST_P(FocusDistances, AreFoundInFrontOfInsideAndBehindTheTags) {
    OpticsCase clip;
    clip.focus_m = [&](std::size_t) { return GetParam(); };
    const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
    ASSERT_TRUE(optics.defocus_seen);
    EXPECT_NEAR(optics.coc_scale.value, clip.coc_scale, 0.05 * clip.coc_scale);
    EXPECT_LT(worst_focus_error(clip, optics), 0.03);
    // A shared error of 5 % in the variance of kernels is allowed for beside noise.
    EXPECT_LT(std::abs(optics.coc_scale.value - clip.coc_scale), 3 * optics.coc_scale.sigma);
    EXPECT_LT(optics.coc_scale.sigma, 0.08 * clip.coc_scale);
}

INSTANTIATE_TEST_SUITE_P(OpticsSolve, FocusDistances, testing::Values(0.42, 0.5, 0.57, 0.66, 0.8, 1.0));

TEST(OpticsSolve, FindsApertures) {
    for (const double coc_scale : {8.0, 15.0, 40.0}) {
        OpticsCase clip;
        clip.coc_scale = coc_scale;
        const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
        ASSERT_TRUE(optics.defocus_seen) << coc_scale;
        EXPECT_NEAR(optics.coc_scale.value, coc_scale, 0.05 * coc_scale);
        EXPECT_LT(worst_focus_error(clip, optics), 0.02) << coc_scale;
        EXPECT_NEAR(optics.softness_px2.value, clip.softness_px2, 0.05) << coc_scale;
    }
}

TEST(OpticsSolve, FollowsARack) {
    // From the far end to the near one within ten frames, still before and after.
    OpticsCase clip;
    clip.frames = 30;
    clip.focus_m = [](std::size_t t) {
        const double way = std::clamp((static_cast<double>(t) - 10) / 10, 0.0, 1.0);
        return 0.72 - 0.2 * way * way * (3 - 2 * way);
    };
    const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
    ASSERT_TRUE(optics.defocus_seen);
    EXPECT_NEAR(optics.coc_scale.value, clip.coc_scale, 0.05 * clip.coc_scale);
    EXPECT_LT(worst_focus_error(clip, optics), 0.03);
}

TEST(OpticsSolve, ErrorsAreAsLargeAsItSays) {
    double focus_squares = 0, scale_squares = 0, shutter_squares = 0;
    constexpr unsigned trials = 12;
    for (unsigned seed = 1; seed <= trials; ++seed) {
        OpticsCase clip;
        clip.frames = 10;
        clip.seed = seed;
        clip.noise_px2 = 0.04;
        clip.unevenness_px2 = 0.05;
        clip.shutter = 0.5;
        clip.motion_px = {4, 3};
        const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
        ASSERT_TRUE(optics.defocus_seen) << seed;
        const Estimate& focus = optics.focus[clip.frames / 2];
        focus_squares += std::pow((focus.value - 1 / 0.6) / focus.sigma, 2) / trials;
        scale_squares += std::pow((optics.coc_scale.value - clip.coc_scale) / optics.coc_scale.sigma, 2) / trials;
        shutter_squares += std::pow((optics.shutter2.value - 0.25) / optics.shutter2.sigma, 2) / trials;
    }
    // Twelve trials scatter by two fifths; the latter two allow for kernels of other shapes, of which there are none.
    EXPECT_GT(focus_squares, 0.3);
    EXPECT_LT(focus_squares, 2);
    EXPECT_LT(scale_squares, 2);
    EXPECT_LT(shutter_squares, 2);
}

TEST(OpticsSolve, FindsTheShutterWithAndWithoutDefocus) {
    for (const double shutter : {0.0, 0.5, 1.0}) {
        for (const double coc_scale : {0.0, 8.0}) {
            OpticsCase clip;
            clip.shutter = shutter;
            clip.coc_scale = coc_scale;
            clip.motion_px = {6, 4};
            const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
            EXPECT_EQ(optics.defocus_seen, coc_scale > 0);
            EXPECT_NEAR(optics.shutter2.value, shutter * shutter, 0.02 + 0.05 * shutter);
        }
    }
}

TEST(OpticsSolve, SharpFootageHasNoFocus) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        OpticsCase clip;
        clip.coc_scale = 0;
        clip.unevenness_px2 = 0.1;
        clip.seed = seed;
        const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
        EXPECT_FALSE(optics.defocus_seen) << seed;
        EXPECT_TRUE(optics.focus.empty());
        EXPECT_NEAR(optics.softness_px2.value, clip.softness_px2, 0.1);
    }
}

TEST(OpticsSolve, DefocusThatDoesNotShowIsLeftOut) {
    // At most 0.8 px across, beside pixels of one.
    OpticsCase clip;
    clip.coc_scale = 2.5;
    const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
    EXPECT_FALSE(optics.defocus_seen);
}

TEST(OpticsSolve, WithoutMotionTheShutterIsOpenToDoubt) {
    OpticsCase clip;
    clip.motion_px = {0.1, 0.1};
    const OpticsSolution optics = solve_optics(readings_of(clip), clip.frames);
    EXPECT_GT(optics.shutter2.sigma, 0.3);
}

TEST(OpticsSolve, TagsThatLieAreOutvoted) {
    OpticsCase clip;
    std::vector<TagBlurReadings> readings = readings_of(clip);
    for (std::size_t i = 0; i < readings.size(); i += 9) {
        for (BlurReading& reading : readings[i].readings) reading.variance_px2 += 3;
    }
    const OpticsSolution optics = solve_optics(readings, clip.frames);
    ASSERT_TRUE(optics.defocus_seen);
    EXPECT_NEAR(optics.coc_scale.value, clip.coc_scale, 0.08 * clip.coc_scale);
    EXPECT_LT(worst_focus_error(clip, optics), 0.03);
}

TEST(OpticsSolve, IsDeterministic) {
    const OpticsCase clip;
    const OpticsSolution once = solve_optics(readings_of(clip), clip.frames);
    const OpticsSolution again = solve_optics(readings_of(clip), clip.frames);
    EXPECT_EQ(once.coc_scale.value, again.coc_scale.value);
    EXPECT_EQ(once.focus[3].value, again.focus[3].value);
}

}  // namespace
}  // namespace matchlight
