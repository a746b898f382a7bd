// What lens and codec do to the virtual layer on plate pixels: chromatic aberration and softness.
#include <algorithm>
#include <cmath>
#include <random>

#include "gl_fixture.h"
#include "render/effects/chromatic_aberration.h"
#include "render/effects/softness.h"
#include "report/softness_reference.h"

namespace matchlight {
namespace {

struct LayerOnCpu {
    ImageF light;     // RGBA
    ImageF coverage;  // RGB; empty: there is none
};

class LayerBlurTest : public GlTest {
protected:
    /// `light` stands at `region` of a frame of 200 × 100.
    template <class Add>
    LayerOnCpu run(const ImageF& light, const Region& region, const Add& add) {
        Texture2D texture({.format = GL_RGBA32F, .width = light.width(), .height = light.height()});
        texture.upload(light);
        RenderGraph graph;
        graph.begin_frame(200, 100);
        PlateLayer layer;
        layer.light = graph.import(&texture, {GL_RGBA32F, region, 1});
        const PlateLayer made = add(graph, layer);
        graph.output(made.light);
        if (made.coverage) graph.output(made.coverage);
        graph.run();
        const Region whole{0, 0, region.width, region.height};
        return {graph.texture(made.light).template read<float>(whole, 4),
                made.coverage ? graph.texture(made.coverage).template read<float>(whole, 3) : ImageF()};
    }
    LayerOnCpu displaced(const ImageF& light, const Region& region, double red_px, double blue_px,
                         QualityLevel level = QualityLevel::final_) {
        return run(light, region, [&](RenderGraph& graph, const PlateLayer& layer) {
            const LateralColor color{red_px, blue_px, 200, 100};
            return add_chromatic_aberration(graph, shaders_, layer, color, chromatic_aberration_knobs(level));
        });
    }
    LayerOnCpu softened(const ImageF& light, const Region& region, double sigma_px, QualityLevel level) {
        return run(light, region, [&](RenderGraph& graph, const PlateLayer& layer) {
            return add_softness(graph, shaders_, layer, sigma_px, softness_knobs(level));
        });
    }

    ShaderLibrary shaders_;
};

ImageF random_layer(int width, int height) {
    ImageF layer(width, height, 4);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> share(0, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float alpha = share(random);
            for (int c = 0; c < 3; ++c) layer.at(x, y, c) = alpha * share(random) * 5;
            layer.at(x, y, 3) = alpha;
        }
    }
    return layer;
}

/// Of a channel weighted by it.
double centre_x(const ImageF& image, int channel) {
    double sum = 0, weights = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            sum += x * static_cast<double>(image.at(x, y, channel));
            weights += image.at(x, y, channel);
        }
    }
    return sum / weights;
}

TEST_F(LayerBlurTest, RedAndBlueLieWhereTheLensPutsThem) {
    // A disc 80 px right of the middle, whose corner is 111.8 px away.
    const Region region{140, 10, 60, 80};
    ImageF layer(60, 80, 4);
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 60; ++x) {
            const double distance = std::hypot(140 + x - 179.5, 10 + y - 49.5);
            const auto inside = static_cast<float>(std::clamp(8.5 - distance, 0.0, 1.0));
            for (int c = 0; c < 4; ++c) layer.at(x, y, c) = inside;
        }
    }
    // What is shown at a radius r came from r - r · k: it lies at 80 / (1 - k).
    const auto shift = [](double corner_px) {
        const double k = corner_px / std::hypot(100, 50);
        return 80 * k / (1 - k);
    };
    for (const QualityLevel level : {QualityLevel::draft, QualityLevel::final_}) {
        const LayerOnCpu moved = displaced(layer, region, 3, -2, level);
        const double still = centre_x(layer, 3);
        EXPECT_NEAR(centre_x(moved.light, 0) - still, shift(3), 0.05);
        EXPECT_EQ(centre_x(moved.light, 1), centre_x(layer, 1));
        EXPECT_NEAR(centre_x(moved.light, 2) - still, shift(-2), 0.05);
        for (int y = 0; y < 80; ++y) {
            for (int x = 0; x < 60; ++x) {
                // White light that covers as much as it shines does so in every channel.
                for (int c = 0; c < 3; ++c) ASSERT_EQ(moved.light.at(x, y, c), moved.coverage.at(x, y, c));
                ASSERT_EQ(moved.light.at(x, y, 3), layer.at(x, y, 3));
            }
        }
    }
}

TEST_F(LayerBlurTest, UnderAQuarterPixelNothingIsDisplaced) {
    const ImageF layer = random_layer(200, 100);
    const LayerOnCpu still = displaced(layer, {0, 0, 200, 100}, 0.25, -0.25);
    EXPECT_TRUE(std::ranges::equal(still.light.samples(), layer.samples()));
    for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 200; ++x) {
            for (int c = 0; c < 3; ++c) ASSERT_EQ(still.coverage.at(x, y, c), layer.at(x, y, 3));
        }
    }
    const LateralColor some{.red_px = 1, .frame_width = 200, .frame_height = 100};
    EXPECT_TRUE(some.is_none({80, 40, 40, 20}));
    EXPECT_FALSE(some.is_none({0, 0, 20, 20}));
    EXPECT_TRUE(some.is_none({}));
    EXPECT_TRUE((LateralColor{.frame_width = 200, .frame_height = 100}).is_none({0, 0, 200, 100}));
}

TEST_F(LayerBlurTest, DisplacedLightStaysBetweenItsNeighbours) {
    const ImageF layer = random_layer(200, 100);
    const auto [least, most] = std::ranges::minmax(layer.samples());
    for (const double wide : {1.7, 100.0}) {
        const LayerOnCpu moved = displaced(layer, {0, 0, 200, 100}, wide, -wide);
        for (const float value : moved.light.samples()) ASSERT_TRUE(value >= least && value <= most) << value;
        for (const float value : moved.coverage.samples()) ASSERT_TRUE(value >= 0 && value <= 1) << value;
    }
}

TEST_F(LayerBlurTest, SoftnessAgreesWithTheReference) {
    const ImageF layer = random_layer(200, 100);
    ImageD exact(200, 100, 4);
    std::ranges::copy(layer.samples(), exact.samples().begin());
    for (const double sigma_px : {0.2, 0.48, 1.0, 2.5}) {
        const ImageD expected = reference_softness(exact, sigma_px);
        const auto worst = [&](QualityLevel level) {
            const ImageF found = softened(layer, {0, 0, 200, 100}, sigma_px, level).light;
            double largest = 0;
            for (std::size_t i = 0; i < expected.samples().size(); ++i) {
                largest = std::max(largest, std::abs(found.samples()[i] - expected.samples()[i]));
            }
            return largest;
        };
        // Light up to 5; what is cut at 5, 3 and 2 deviations.
        EXPECT_LT(worst(QualityLevel::reference), 1e-4) << sigma_px;
        EXPECT_LT(worst(QualityLevel::final_), 0.05) << sigma_px;
        EXPECT_LT(worst(QualityLevel::preview), 0.5) << sigma_px;
    }
}

TEST_F(LayerBlurTest, SoftnessKeepsEnergyAndTheFramesEdge) {
    // A layer that fills the frame stays as it is, the edge included.
    ImageF full(200, 100, 4, 0.75F);
    const LayerOnCpu still = softened(full, {0, 0, 200, 100}, 1.5, QualityLevel::final_);
    for (const float value : still.light.samples()) ASSERT_NEAR(value, 0.75, 1e-6);
    ImageF spot(60, 80, 4);
    for (int c = 0; c < 4; ++c) spot.at(30, 40, c) = 1e5F;
    double sum = 0;
    const LayerOnCpu spread = softened(spot, {100, 10, 60, 80}, 1.5, QualityLevel::final_);
    for (const float value : spread.light.samples()) sum += value;
    EXPECT_NEAR(sum / 4e5, 1, 1e-6);
}

TEST_F(LayerBlurTest, NarrowSoftnessIsNone) {
    const ImageF layer = random_layer(30, 20);
    const ImageF found = softened(layer, {5, 5, 30, 20}, 0.199, QualityLevel::final_).light;
    EXPECT_TRUE(std::ranges::equal(found.samples(), layer.samples()));
    EXPECT_EQ(softness_reach_px(0.199, {}), 0);
    EXPECT_EQ(softness_reach_px(0.5, {}), 2);
}

TEST_F(LayerBlurTest, SoftnessBlursTheCoverageOfEachChannel) {
    ImageF layer(200, 100, 4);
    for (int y = 0; y < 100; ++y) {
        for (int x = 150; x < 200; ++x) layer.at(x, y, 3) = 1;  // black
    }
    const LayerOnCpu made = run(layer, {0, 0, 200, 100}, [&](RenderGraph& graph, const PlateLayer& in) {
        const PlateLayer parted = add_chromatic_aberration(graph, shaders_, in, {3, -3, 200, 100}, {});
        return add_softness(graph, shaders_, parted, 0.6, {});
    });
    // The edge lies 1.36 px, over two of the Gaussian's deviations, farther left in blue and farther right in red: a
    // pixel outside of it is covered in blue, one inside is not in red.
    EXPECT_GT(made.coverage.at(149, 50, 2), 0.8);
    EXPECT_LT(made.coverage.at(150, 50, 0), 0.2);
    // Along a row each channel's edge is a step that the Gaussian has softened.
    int soft = 0;
    for (int x = 140; x < 160; ++x) soft += made.coverage.at(x, 50, 1) > 0.01 && made.coverage.at(x, 50, 1) < 0.99;
    EXPECT_EQ(soft, 2);
}

}  // namespace
}  // namespace matchlight
