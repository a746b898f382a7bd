// Grain: the noise of single pixels against its reference, and its variance, correlation and independence.
#include "render/effects/grain.h"

#include <cmath>

#include "gl/framebuffer.h"
#include "gl_fixture.h"
#include "report/grain_reference.h"

namespace matchlight {
namespace {

class GrainTest : public GlTest {
protected:
    ImageF noise(const GrainModel& model, const Region& region) {
        RenderGraph graph;
        graph.begin_frame(640, 480);
        const GraphTexture made = grain_.add(graph, model, region);
        graph.output(made);
        graph.run();
        EXPECT_EQ(graph.shape(made).region, region);
        return graph.texture(made).read<float>({0, 0, region.width, region.height}, 3);
    }

    ShaderLibrary shaders_;
    GrainNoise grain_{shaders_};
};

/// Mean of products of two pictures, the second one `shift` columns and rows further.
double product_of(const ImageF& a, const ImageF& b, int channel_a, int channel_b, int shift_x, int shift_y) {
    double sum = 0;
    for (int y = 0; y + shift_y < a.height(); ++y) {
        for (int x = 0; x + shift_x < a.width(); ++x) {
            sum += static_cast<double>(a.at(x, y, channel_a)) * b.at(x + shift_x, y + shift_y, channel_b);
        }
    }
    return sum / ((a.width() - shift_x) * (a.height() - shift_y));
}

TEST_F(GrainTest, AgreesWithTheReferenceAtEveryPixel) {
    for (const double correlation_px : {0.0, 0.4, 1.5}) {
        const GrainModel model{.correlation_px = correlation_px, .seed = 7, .frame = 1234};
        const Region region{-3, 470, 40, 25};  // over the frame's corner
        const ImageF found = noise(model, region);
        const ImageD expected = reference_grain_noise(model, region);
        double worst = 0;
        for (std::size_t i = 0; i < expected.samples().size(); ++i) {
            worst = std::max(worst, std::abs(found.samples()[i] - expected.samples()[i]));
        }
        // Single precision; taps that end at 4 standard deviations, where 3e-4 of the noise is.
        EXPECT_LT(worst, correlation_px == 0 ? 1e-6 : 2e-3) << correlation_px;
    }
}

TEST_F(GrainTest, HasTheVarianceAndTheCorrelationAskedFor) {
    const Region region{0, 0, 512, 384};
    for (const double correlation_px : {0.0, 0.5, 1.0}) {
        const ImageF found = noise({.correlation_px = correlation_px}, region);
        const double neighbour = grain_neighbour_correlation(correlation_px);
        // Four standard errors; products of correlated noise count for fewer.
        const double counted = 512 * 384 / std::pow(1 + 2 * neighbour, 2);
        const double error = 4 * std::sqrt(2 / counted);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(product_of(found, found, c, c, 0, 0), 1, error) << correlation_px;
            EXPECT_NEAR(product_of(found, found, c, c, 1, 0), neighbour, error) << correlation_px;
            EXPECT_NEAR(product_of(found, found, c, c, 0, 1), neighbour, error) << correlation_px;
            EXPECT_NEAR(product_of(found, found, c, (c + 1) % 3, 0, 0), 0, error) << correlation_px;
            double mean = 0;
            for (int y = 0; y < found.height(); ++y) {
                for (int x = 0; x < found.width(); ++x) mean += found.at(x, y, c) / (512.0 * 384.0);
            }
            EXPECT_NEAR(mean, 0, error);
        }
    }
}

TEST_F(GrainTest, FramesAndSeedsAreIndependent) {
    const Region region{0, 0, 256, 256};
    const ImageF first = noise({.frame = 10}, region);
    const double error = 4.0 / 256;
    EXPECT_NEAR(product_of(first, noise({.frame = 11}, region), 1, 1, 0, 0), 0, error);
    EXPECT_NEAR(product_of(first, noise({.seed = 2, .frame = 10}, region), 1, 1, 0, 0), 0, error);
    EXPECT_NEAR(product_of(first, first, 1, 1, 0, 0), 1, error);
}

TEST_F(GrainTest, APixelsNoiseIsTheSameInAnyRegion) {
    const GrainModel model{.correlation_px = 0.8, .frame = 3};
    const ImageF whole = noise(model, {0, 0, 200, 100});
    const ImageF part = noise(model, {57, 31, 40, 20});
    for (int y = 0; y < part.height(); ++y) {
        for (int x = 0; x < part.width(); ++x) {
            for (int c = 0; c < 3; ++c) ASSERT_EQ(part.at(x, y, c), whole.at(57 + x, 31 + y, c));
        }
    }
}

}  // namespace
}  // namespace matchlight
