// Depth of field against the thin lens in double precision: discs, edges, and what a blurred object hides.
#include "render/effects/depth_of_field.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "gl_fixture.h"
#include "glass_model.h"
#include "report/lens_cards.h"

namespace matchlight {
namespace {

/// Four layer pixels along a plate pixel's side, which share its edges.
Quality fine_quality() {
    Quality quality = quality_of(QualityLevel::draft);
    quality.supersampling = 4;
    return quality;
}

DepthOfFieldSettings lens_samples(int count) {
    DepthOfFieldSettings settings;
    settings.level = DepthOfFieldLevel::lens_samples;
    settings.lens_samples = count;
    return settings;
}

double sum_of(const ImageF& picture, int channel) {
    double sum = 0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) sum += picture.at(x, y, channel);
    }
    return sum;
}

/// Largest difference of any channel from the reference.
double largest_error(const ImageF& picture, const ImageD& reference) {
    double largest = 0;
    for (std::size_t i = 0; i < picture.samples().size(); ++i)
        largest = std::max(largest, std::abs(picture.samples()[i] - reference.samples()[i]));
    return largest;
}

LensCard card(const std::array<double, 4>& left_top_right_bottom, double depth_m, const Eigen::Vector3d& color) {
    const auto& [left, top, right, bottom] = left_top_right_bottom;
    return {.left_px = left,
            .top_px = top,
            .right_px = right,
            .bottom_px = bottom,
            .depth_m = depth_m,
            .light = {color[0], color[1], color[2], 1}};
}

class DepthOfFieldTest : public GlTest {
protected:
    static ImageF drawn(const ThinLensView& view, const DepthOfFieldSettings& settings) {
        return composited_cards(context(), lens_card_shot(view, settings), fine_quality());
    }
};

TEST_F(DepthOfFieldTest, LensSamplesMakeDiscsOfTheCircleOfConfusion) {
    const Focus focus{.coc_scale_px_m = 20, .focus_distance_m = 1};
    for (const double depth_m : {0.5, 2.5}) {
        const ThinLensView view{.width = 65,
                                .height = 65,
                                .focus = focus,
                                .bokeh = {},
                                .cards = {card({31.5, 31.5, 32.5, 32.5}, depth_m, {1000, 1000, 1000})}};
        const ImageF picture = drawn(view, lens_samples(256));
        const double light = sum_of(picture, 0);
        double x_px = 0, y_px = 0, variance = 0;
        for (int y = 0; y < 65; ++y) {
            for (int x = 0; x < 65; ++x) {
                const double share = picture.at(x, y, 0) / light;
                x_px += (x - 32.0) * share;
                y_px += (y - 32.0) * share;
                variance += ((x - 32.0) * (x - 32.0) + (y - 32.0) * (y - 32.0)) * share;
            }
        }
        // The light of the highlight's one pixel; each layer pixel is in the picture or not, a sixteenth of it.
        EXPECT_NEAR(light, 1000, 10) << depth_m;
        EXPECT_NEAR(x_px, 0, 0.05) << depth_m;
        EXPECT_NEAR(y_px, 0, 0.05) << depth_m;
        // An even disc's own variance is a sixteenth of its diameter squared on each axis; beside it the highlight's
        // square and the plate pixel's.
        const double squares = 2 * (1.0 / 12 + 1.0 / 12);
        const double diameter_px = std::sqrt(8 * (variance - squares));
        EXPECT_NEAR(diameter_px / std::abs(signed_coc_px(focus, depth_m)), 1, 0.01) << depth_m;
    }
}

TEST_F(DepthOfFieldTest, LensSamplesBlurAnEdgeAsTheLensDoes) {
    // From before the focus, and from beyond it.
    for (const double depth_m : {0.5, 2.0}) {
        ThinLensView view{.width = 33,
                          .height = 33,
                          .focus = {.coc_scale_px_m = 10, .focus_distance_m = 1},
                          .bokeh = {},
                          .cards = {card({-40.5, -40.5, 16.5, 72.5}, depth_m, {1, 0.5, 0.25})}};
        // Points along the edge move the picture by steps: 1/√N is a wide bound of what a column of them leaves.
        constexpr int samples = 256;
        EXPECT_LT(largest_error(drawn(view, lens_samples(samples)), thin_lens_light(view)), 0.6 / std::sqrt(samples))
            << depth_m;
    }
}

TEST_F(DepthOfFieldTest, LensSamplesSeeBehindWhatIsBlurred) {
    for (const BokehSettings& bokeh : {BokehSettings{}, BokehSettings{.blades = 5, .rotation_deg = 20}}) {
        // A red card before the focus, over a green one in focus that it hides in part, over a blue one far behind.
        const ThinLensView view{
            .width = 33,
            .height = 33,
            .focus = {.coc_scale_px_m = 10, .focus_distance_m = 1},
            .bokeh = bokeh,
            .cards = {card({3.5, 3.5, 18.5, 29.5}, 0.5, {1, 0, 0}), card({12.5, 7.5, 27.5, 24.5}, 1, {0, 1, 0}),
                      card({-40.5, -40.5, 21.5, 72.5}, 4, {0, 0, 1})}};
        constexpr int samples = 256;
        EXPECT_LT(largest_error(drawn(view, lens_samples(samples)), thin_lens_light(view)), 0.6 / std::sqrt(samples));
    }
}

TEST_F(DepthOfFieldTest, AllThatKnowTheOpeningShowItTheSameWayUp) {
    // Light from before the focus and from beyond it, through a triangle with a corner to the right.
    const BokehSettings triangle{.blades = 3};
    for (const double depth_m : {0.5, 4.0}) {
        const ThinLensView view{.width = 49,
                                .height = 49,
                                .focus = {.coc_scale_px_m = 20, .focus_distance_m = 1},
                                .bokeh = triangle,
                                .cards = {card({23.625, 23.625, 24.625, 24.625}, depth_m, {1000, 1000, 1000})}};
        // Third moment along x about the middle of the light: positive where the corner points to the right.
        const auto skew = [&](const auto& picture) {
            double light = 0, middle = 0, sum = 0;
            for (int i = 0; i < 49 * 49; ++i) {
                light += picture.at(i % 49, i / 49, 0);
                middle += i % 49 * picture.at(i % 49, i / 49, 0);
            }
            for (int i = 0; i < 49 * 49; ++i)
                sum += std::pow(i % 49 - middle / light, 3) * picture.at(i % 49, i / 49, 0);
            return sum / light;
        };
        const double expected = skew(thin_lens_light(view));
        EXPECT_GT(std::abs(expected), 10) << depth_m;
        for (const DepthOfFieldLevel level :
             {DepthOfFieldLevel::gather, DepthOfFieldLevel::layers, DepthOfFieldLevel::lens_samples}) {
            DepthOfFieldSettings settings = lens_samples(256);
            settings.level = level;
            Quality quality = fine_quality();
            quality.depth_of_field = QualityLevel::final_;
            const ImageF seen = composited_cards(context(), lens_card_shot(view, settings), quality);
            // Discs of few texels have less of a corner.
            EXPECT_GT(skew(seen) / expected, 0.25) << static_cast<int>(level);
        }
    }
}

TEST_F(DepthOfFieldTest, GatherFollowsTheFocusOfAnObjectAsLensSamplesDo) {
    // Far out of focus by their depth: one is focused by itself, one never blurred, one blurred as if elsewhere.
    const ThinLensView view{.width = 65,
                            .height = 65,
                            .focus = {.coc_scale_px_m = 20, .focus_distance_m = 1},
                            .bokeh = {},
                            .cards = {card({4, 20, 16, 44}, 0.5, {1, 0, 0}), card({26, 20, 38, 44}, 2, {0, 1, 0}),
                                      card({48, 20, 60, 44}, 1, {0, 0, 1})}};
    DepthOfFieldSettings gather;
    Quality quality = fine_quality();
    quality.depth_of_field = QualityLevel::final_;
    std::vector<ImageF> pictures;
    for (const DepthOfFieldSettings& settings : {gather, lens_samples(256)}) {
        LensCardShot shot = lens_card_shot(view, settings);
        shot.scene.objects[0].focus = FocusOverride{.distance_m = 0.5};
        shot.scene.objects[1].focus = FocusOverride{};
        shot.scene.objects[2].focus = FocusOverride{.distance_m = 2};
        pictures.push_back(composited_cards(context(), shot, quality));
    }
    const ImageF sharp = composited_cards(context(), lens_card_shot(view, std::nullopt), fine_quality());
    double most = 0;
    for (int y = 0; y < 65; ++y) {
        for (int x = 0; x < 65; ++x) {
            const double difference = std::abs(pictures[0].at(x, y, 3) - pictures[1].at(x, y, 3));
            most = std::max(most, difference);
            if (x < 42) {
                EXPECT_NEAR(pictures[0].at(x, y, 3), sharp.at(x, y, 3), 1e-3) << x << ' ' << y;
            }
        }
    }
    // Half the light's edge lies between two of the lens' points, or two texels of the disc.
    EXPECT_LT(most, 0.06);
    EXPECT_NEAR(pictures[0].at(48, 32, 3), 0.5, 0.1);
}

TEST_F(DepthOfFieldTest, GatherBlursWhatLetsLightThroughAtItsOwnDepth) {
    const test::GlassModel glass(0.4);
    // The glass stands before a card, beside which it shows the plate; either is in focus.
    for (const double focus_m : {1.0, 2.0}) {
        const ThinLensView view{.width = 65,
                                .height = 65,
                                .focus = {.coc_scale_px_m = 16, .focus_distance_m = focus_m},
                                .bokeh = {},
                                .cards = {card({30, 14, 54, 40}, 2, {1, 0.5, 0})}};
        Quality quality = fine_quality();
        quality.depth_of_field = QualityLevel::final_;
        std::vector<ImageF> pictures;
        for (const DepthOfFieldSettings& settings : {DepthOfFieldSettings{}, lens_samples(256)}) {
            LensCardShot shot = lens_card_shot(view, settings);
            ObjectSettings& pane = shot.scene.objects.emplace_back();
            pane.model = glass.path();
            pane.scale = Eigen::Vector3d::Constant(0.2);
            pane.translate_m = {-0.05, 1, -0.05};
            pictures.push_back(composited_cards(context(), shot, quality));
        }
        double most = 0, seen = 0;
        for (std::size_t i = 0; i < pictures[0].samples().size(); ++i) {
            most = std::max<double>(most, std::abs(pictures[0].samples()[i] - pictures[1].samples()[i]));
            seen = std::max<double>(seen, pictures[1].samples()[i]);
        }
        EXPECT_LT(most, 0.06) << focus_m;
        EXPECT_GT(seen, 0.9);
        // Glass alone, the card through it, and the card alone.
        EXPECT_NEAR(pictures[0].at(22, 43, 3), 0.4, 0.01) << focus_m;
        EXPECT_NEAR(pictures[0].at(36, 30, 0), 0.6, 0.01) << focus_m;
        EXPECT_NEAR(pictures[0].at(49, 24, 0), 1, 0.01) << focus_m;
    }
}

TEST_F(DepthOfFieldTest, WhatStandsBesideTheFrameBlursIntoIt) {
    // Two pixels beside the frame on the right; its disc is 20 px wide.
    for (const double depth_m : {0.5, 1e3}) {
        const ThinLensView view{.width = 33,
                                .height = 33,
                                .focus = {.coc_scale_px_m = 20, .focus_distance_m = 1},
                                .bokeh = {},
                                .cards = {card({34.625, 6.625, 42.625, 26.625}, depth_m, {1, 0.5, 0.25})}};
        const ImageD expected = thin_lens_light(view);
        EXPECT_GT(expected.at(32, 16, 0), 0.2);
        for (const DepthOfFieldLevel level : {DepthOfFieldLevel::gather, DepthOfFieldLevel::lens_samples}) {
            DepthOfFieldSettings settings = lens_samples(256);
            settings.level = level;
            Quality quality = fine_quality();
            quality.depth_of_field = QualityLevel::final_;
            const ImageF seen = composited_cards(context(), lens_card_shot(view, settings), quality);
            EXPECT_LT(largest_error(seen, expected), 0.06) << depth_m << ", " << static_cast<int>(level);
        }
    }
}

}  // namespace
}  // namespace matchlight
