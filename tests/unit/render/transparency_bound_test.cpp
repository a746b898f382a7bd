// How many layers must be peeled, from opacity and tolerance.
#include "render/transparency_bound.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "calibration/response.h"

namespace matchlight {
namespace {

CodeOfChannel code_of(const Response& response, double gain = 1) {
    return [response, gain](double light, int channel) { return response.code_from_linear(gain * light, channel); };
}

double linear_code(double light, int) {
    return light;
}

TEST(TransparencyBound, ThirtyTwoLayersAtAToleranceOfEightNeedTheStudysOpacity) {
    EXPECT_NEAR(opacity_of_layers(32, residual_of_tolerance(8)), 0.121767, 5e-7);
}

TEST(TransparencyBound, LayersAndOpacityAreEachOthersInverse) {
    for (const double tolerance : {1.0, 4.0, 8.0, 30.0}) {
        const double residual = residual_of_tolerance(tolerance);
        for (const int layers : {1, 2, 8, 32, 250}) {
            const double opacity = opacity_of_layers(layers, residual);
            EXPECT_EQ(layers_of_opacity(opacity, residual), layers);
            EXPECT_EQ(layers_of_opacity(opacity * (1 - 1e-6), residual), layers + 1);
            EXPECT_NEAR(std::pow(1 - opacity, layers), residual, 1e-12);
        }
    }
}

TEST(TransparencyBound, HoldsAtTheEndsOfOpacity) {
    const double residual = residual_of_tolerance(8);
    EXPECT_EQ(layers_of_opacity(1, residual), 1);
    EXPECT_EQ(layers_of_opacity(0, residual), most_peeled_layers);
    EXPECT_EQ(layers_of_opacity(std::numeric_limits<double>::quiet_NaN(), residual), most_peeled_layers);
    EXPECT_EQ(layers_of_opacity(1e-4, residual), 41548);  // ln(8/510) / ln(1 − 1e-4) = 41547.5
    EXPECT_EQ(layers_of_opacity(1e-12, residual), most_peeled_layers);
    EXPECT_EQ(layers_of_opacity(0.5, residual_of_tolerance(510)), 0);
}

TEST(TransparencyBound, IsTheStudysWhereCodesAreLinearInLight) {
    EXPECT_NEAR(residual_of_tolerance(linear_code, Eigen::Vector3d::Ones(), 8) / residual_of_tolerance(8), 1, 1e-6);
    EXPECT_TRUE(may_stop(linear_code, {0.2, 0.3, 0.1}, 0.999 * residual_of_tolerance(8), Eigen::Vector3d::Ones(), 8));
    EXPECT_FALSE(may_stop(linear_code, {0.2, 0.3, 0.1}, 1.001 * residual_of_tolerance(8), Eigen::Vector3d::Ones(), 8));
}

TEST(TransparencyBound, ATransmittanceOfFourCodesIsManyCodesAfterTheResponse) {
    const CodeOfChannel srgb = code_of(Response::srgb());
    // In the dark sRGB makes 34 codes of light of 4/255 (NUMERICS' row): the study's form would stop there at t = 8.
    EXPECT_NEAR(residual_codes(srgb, Eigen::Vector3d::Zero(), 4.0 / 255, Eigen::Vector3d::Ones()), 34, 0.5);
    // In white it makes fewer than 2.
    EXPECT_LT(residual_codes(srgb, Eigen::Vector3d::Ones(), 4.0 / 255, Eigen::Vector3d::Ones()), 2);
    // sRGB's straight part: 255 · 12.92 · T = 4 codes.
    EXPECT_NEAR(residual_of_tolerance(srgb, Eigen::Vector3d::Ones(), 8), 4 / (255 * 12.92), 1e-8);
}

TEST(TransparencyBound, TheBrightestChannelDecides) {
    const Eigen::Vector3d lamp(0.1, 20, 0.1);
    const CodeOfChannel srgb = code_of(Response::srgb());
    EXPECT_NEAR(residual_of_tolerance(srgb, lamp, 8), 4 / (255 * 12.92) / 20, 1e-9);
    EXPECT_GT(residual_codes(srgb, Eigen::Vector3d::Zero(), 1e-3, lamp),
              residual_codes(srgb, Eigen::Vector3d::Zero(), 1e-3, {0.1, 0.1, 0.1}));
}

TEST(TransparencyBound, NothingBehindStopsAtOnceAndWhatIsNotFiniteNever) {
    const CodeOfChannel srgb = code_of(Response::srgb());
    EXPECT_TRUE(may_stop(srgb, Eigen::Vector3d::Zero(), 1, Eigen::Vector3d::Zero(), 1));
    EXPECT_EQ(residual_of_tolerance(srgb, Eigen::Vector3d::Zero(), 1), 1);
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(may_stop(srgb, Eigen::Vector3d::Zero(), 1e-9, {infinite, 1, 1}, 8));
    EXPECT_FALSE(may_stop(srgb, Eigen::Vector3d::Zero(), std::nan(""), Eigen::Vector3d::Ones(), 8));
}

TEST(TransparencyBound, NoLightBehindChangesMoreThanHalfTheTolerance) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    const Response response = Response::shoulder({.gamma = 0, .knee = 0.5, .white = 4}, "made");
    for (const double gain : {0.1, 1.0, 8.0}) {
        const CodeOfChannel code = code_of(response, gain);
        const Eigen::Vector3d most = Eigen::Vector3d::Constant(3);
        const double residual = residual_of_tolerance(code, most, 8);
        for (int i = 0; i < 2000; ++i) {
            const double gathered = 3 * std::pow(10, -6 * uniform(random));
            const double before = code(gathered, 0), after = code(gathered + residual * 3 * uniform(random), 0);
            EXPECT_LE(255 * (after - before), 4 * (1 + 1e-6)) << gain << " " << gathered;
        }
    }
}

}  // namespace
}  // namespace matchlight
