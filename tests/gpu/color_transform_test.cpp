// Colours of the virtual layer transformed, and repeated boxes, against double precision.
#include "render/effects/color_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/transfer.h"
#include "gl_fixture.h"
#include "render/effects/repeated_blur.h"
#include "report/color_transform_reference.h"

namespace matchlight {
namespace {

constexpr int width = 96, height = 64;

/// Premultiplied light of every colour up to twice white, some of it covering nothing, some black, grey or one channel.
ImageF colors() {
    ImageF layer(width, height, 4);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> share(0, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float alpha = x % 8 == 0 ? 0 : x % 8 == 1 ? 1 : share(random);
            std::array<float, 3> color{2 * share(random), 2 * share(random), 2 * share(random)};
            if (y % 8 == 0) color = {};
            if (y % 8 == 1) color = {color[0], color[0], color[0]};
            if (y % 8 == 2) color = {color[0], 0, 0};
            for (int c = 0; c < 3; ++c) layer.at(x, y, c) = alpha * color[static_cast<std::size_t>(c)];
            layer.at(x, y, 3) = alpha;
        }
    }
    return layer;
}

ImageD doubles(const ImageF& image) {
    ImageD copy(image.width(), image.height(), image.channels());
    std::ranges::copy(image.samples(), copy.samples().begin());
    return copy;
}

ColorTable curved_table() {
    ColorTable table{.size = color_table_size, .rgb = {}};
    for (int blue = 0; blue < table.size; ++blue) {
        for (int green = 0; green < table.size; ++green) {
            for (int red = 0; red < table.size; ++red) {
                const float scale = 1 / static_cast<float>(table.size - 1);
                const float r = static_cast<float>(red) * scale, g = static_cast<float>(green) * scale,
                            b = static_cast<float>(blue) * scale;
                table.rgb.insert(table.rgb.end(), {r * r, 0.5F * (g + b * r), 1 - b});
            }
        }
    }
    return table;
}

class ColorTransformTest : public GlTest {
protected:
    template <class Add>
    ImageF run(const ImageF& light, const Add& add) {
        Texture2D texture({.format = GL_RGBA32F, .width = light.width(), .height = light.height()});
        texture.upload(light);
        RenderGraph graph;
        graph.begin_frame(light.width(), light.height());
        PlateLayer layer;
        layer.light = graph.import(&texture, {GL_RGBA32F, light.bounds(), 1});
        const PlateLayer made = add(graph, layer);
        graph.output(made.light);
        graph.run();
        return graph.texture(made.light).read<float>(light.bounds(), 4);
    }
    ImageF transformed(const ColorTransformSettings& settings, const ColorTransformFiles& files = {},
                       const Eigen::Vector3d& gain = Eigen::Vector3d::Ones()) {
        const ColorTransform transform(settings, files, {});
        return run(colors(), [&](RenderGraph& graph, const PlateLayer& layer) {
            return transform.add(graph, shaders_, layer, {.gain = gain, .mask_frame = {0, 0, width, height}});
        });
    }
    /// The greatest difference from the reference, in codes of 1 of what covers at least a tenth.
    static double worst_code(const ImageF& made, const ImageD& reference, const Color& gain) {
        double worst = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double alpha = reference.at(x, y, 3);
                EXPECT_EQ(made.at(x, y, 3), static_cast<float>(alpha));
                if (alpha < 0.1) continue;
                for (int c = 0; c < 3; ++c) {
                    const double g = gain[static_cast<std::size_t>(c)] / alpha;
                    worst = std::max(worst, std::abs(srgb_code_from_linear(made.at(x, y, c) * g) -
                                                     srgb_code_from_linear(reference.at(x, y, c) * g)));
                }
            }
        }
        return worst;
    }

    ShaderLibrary shaders_;
};

TEST_F(ColorTransformTest, EveryPartIsItsReference) {
    const ColorTransformFiles with_table{.table = curved_table(), .mask = {}};
    struct Case {
        const char* name;
        ColorTransformSettings settings;
        bool table = false;
    };
    const std::vector<Case> cases{
        {"matrix", {.matrix = {{{0.2, 0.5, 0.3}, {1, -0.5, 0.4}, {0, 0.1, 0.9}}}}},
        {"hsv", {.hue_deg = 75, .saturation = 0.6, .value = 1.2}},
        {"hsv, more saturated, backwards", {.hue_deg = -400, .saturation = 3}},
        {"yiq", {.model = ColorModel::yiq, .hue_deg = 75, .saturation = 0.6, .value = 1.2}},
        {"contrast and brightness", {.contrast = 1.7, .brightness = -0.1}},
        {"inverted", {.contrast = -1}},
        {"grey by HSV", {.grey = GreyKind::hsv}},
        {"grey by average", {.grey = GreyKind::average}},
        {"grey by YIQ, tinted", {.grey = GreyKind::yiq, .tint = {1, 0.8, 0.55}}},
        {"fade", {.fade = 0.35, .fade_color = {0.9, 0.2, 0.1}}},
        {"table", {}, true},
        {"all", {.hue_deg = 20, .saturation = 1.3, .contrast = 1.1, .brightness = 0.05, .fade = 0.2}, true},
    };
    const Color gain{0.7, 1.1, 1.6};
    for (const Case& tried : cases) {
        ImageD reference = doubles(colors());
        reference_transform_layer(reference, gain, tried.settings, tried.table ? &*with_table.table : nullptr);
        const ImageF made =
            transformed(tried.settings, tried.table ? with_table : ColorTransformFiles{}, {gain[0], gain[1], gain[2]});
        // Contrast and saturation multiply float's error; an eighth of a code of 8 bits would be 5e-4.
        EXPECT_LT(worst_code(made, reference, gain), 1e-4) << tried.name;
    }
}

TEST_F(ColorTransformTest, RoundTripsKeepColors) {
    // A full turn goes through the model and back; only then is it drawn as one.
    for (const ColorModel model : {ColorModel::hsv, ColorModel::yiq}) {
        const ImageF made = transformed({.model = model, .hue_deg = 360});
        ImageD before = doubles(colors());
        EXPECT_LT(worst_code(made, before, {1, 1, 1}), 1e-5) << static_cast<int>(model);
    }
    for (int i = 0; i < 1000; ++i) {
        const Color rgb{(i % 10) / 9.0, (i / 10 % 10) / 9.0, i / 100 / 9.0};
        const Color by_hsv = reference_rgb_from_hsv(reference_hsv_from_rgb(rgb));
        const Color by_yiq = reference_rgb_from_yiq(reference_yiq_from_rgb(rgb));
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(by_hsv[c], rgb[c], 1e-12);
            EXPECT_NEAR(by_yiq[c], rgb[c], 1e-12);
        }
    }
}

TEST_F(ColorTransformTest, LightThatCoversNothingStays) {
    const ImageF made = transformed({.contrast = -1, .brightness = 0.3});
    const ImageF before = colors();
    for (int y = 0; y < height; ++y) {
        for (int c = 0; c < 4; ++c) EXPECT_EQ(made.at(0, y, c), before.at(0, y, c));
    }
}

TEST_F(ColorTransformTest, LeavingOutWhatChangesNoColorChangesNoBit) {
    ASSERT_TRUE(ColorTransformSettings{}.is_identity());
    EXPECT_TRUE(std::ranges::equal(transformed({}, {}, {0.7, 1.1, 1.6}).samples(), colors().samples()));
    EXPECT_FALSE(std::ranges::equal(transformed({.brightness = 1e-3}).samples(), colors().samples()));
}

TEST_F(ColorTransformTest, AMaskSaysWhere) {
    ImageF mask(2, 1, 1);
    mask.at(1, 0) = 1;
    const ColorTransformSettings settings{.contrast = -1};
    const ImageF made = transformed(settings, {.table = {}, .mask = mask}), everywhere = transformed(settings);
    const ImageF before = colors();
    // Of two pixels over the frame, the outer quarters are one's own, and between them it is mixed.
    for (int y = 0; y < height; ++y) {
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(made.at(5, y, c), before.at(5, y, c));
            EXPECT_NEAR(made.at(width - 5, y, c), everywhere.at(width - 5, y, c), 1e-6);
        }
    }
}

TEST_F(ColorTransformTest, RepeatedBoxesAreTheirReferenceAndKeepLight) {
    for (const RepeatedBlurSettings& settings :
         {RepeatedBlurSettings{1, 3}, RepeatedBlurSettings{5, 1}, RepeatedBlurSettings{3, 4}}) {
        const ImageD reference = reference_repeated_blur(doubles(colors()), settings);
        const auto blurred = [&](QualityLevel level) {
            return run(colors(), [&](RenderGraph& graph, const PlateLayer& layer) {
                return add_repeated_blur(graph, shaders_, layer, settings, repeated_blur_knobs(level));
            });
        };
        const ImageF exact = blurred(QualityLevel::final_), quick = blurred(QualityLevel::draft);
        double worst = 0, quick_error = 0, unblurred_error = 0;
        const ImageF before = colors();
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < 4; ++c) {
                    const double wanted = reference.at(x, y, c);
                    worst = std::max(worst, std::abs(exact.at(x, y, c) - wanted));
                    quick_error += std::pow(quick.at(x, y, c) - wanted, 2);
                    unblurred_error += std::pow(before.at(x, y, c) - wanted, 2);
                }
            }
        }
        EXPECT_LT(worst, 1e-5) << settings.passes << " of " << settings.radius_px;
        // One Gaussian in place of several boxes is near them; of a single box it is only as wide.
        EXPECT_LT(quick_error, (settings.passes > 1 ? 0.01 : 0.1) * unblurred_error) << settings.passes;
    }
    const RepeatedBlurSettings none{4, 0};
    EXPECT_EQ(repeated_blur_reach_px(none, {}), 0);
    EXPECT_EQ(repeated_blur_reach_px({3, 4}, {}), 12);
}

}  // namespace
}  // namespace matchlight
