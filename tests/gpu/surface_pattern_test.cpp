// Patterns on surfaces: free of what a picture cannot hold, and as sums in double precision say; layers of pictures.
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "core/transfer.h"
#include "gl_fixture.h"
#include "render_scene.h"
#include "report/pattern_reference.h"
#include "scene/surface_pictures.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using test::make_square;
using test::TestCamera;

class SurfacePattern : public GlTest {
protected:
    /// Seen from straight above, a pixel is a square of this side.
    static constexpr double pixel_m = 1e-3;
    static constexpr int size = 65;

    /// The middle row, the camera moved to the right by so many pixels.
    std::vector<double> row_of(const PatternSettings& pattern, double pixels_right) {
        const ImageF image = drawn(pattern, pixels_right);
        std::vector<double> row;
        for (int x = 0; x < size; ++x) row.push_back(image.at(x, size / 2));
        return row;
    }
    ImageF drawn(const PatternSettings& pattern, double pixels_right) {
        SurfacePictures pictures{.settings = {}, .heights = {}, .layers = {}};
        pictures.settings.pattern = pattern;
        return drawn(pictures, make_square(1), pixels_right);
    }
    ImageF drawn(const SurfacePictures& pictures, Model square, double pixels_right) {
        square.materials[0].unlit = true;
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &square, .pictures = &pictures});
        const TestCamera camera{.eye = {pixels_right * pixel_m, 0, 0.4},
                                .forward = -Vector3d::UnitZ(),
                                .right = Vector3d::UnitX(),
                                .size = size,
                                .focal_px = 0.4 / pixel_m};
        const SurfacePicture picture = renderer.draw(environment_, camera.view(1));
        return picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
    }

    ShaderLibrary shaders_;
    const Environment environment_{shaders_, test::uniform_probe(1)};
};

/// Of a signal sampled `per_pixel` times a pixel, its energy above half a period a pixel.
double energy_above_nyquist(const std::vector<double>& samples, int per_pixel) {
    const auto count = static_cast<int>(samples.size());
    double mean = 0, energy = 0;
    for (const double sample : samples) mean += sample / count;
    for (int bin = 0; bin <= count / 2; ++bin) {
        // A window's main lobe is two bins wide on each side.
        if (static_cast<double>(bin - 2) / count * per_pixel < 0.5) continue;
        std::complex<double> sum = 0;
        for (int i = 0; i < count; ++i) {
            const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / count);
            sum += window * (samples[static_cast<std::size_t>(i)] - mean) *
                   std::polar(1.0, -2 * std::numbers::pi * bin * i / count);
        }
        energy += std::norm(sum);
    }
    return energy;
}

TEST_F(SurfacePattern, SquareWaveHasNothingAboveNyquist) {
    constexpr int per_pixel = 16;
    for (const double periods_a_pixel : {0.03, 0.11, 0.3, 0.45, 0.55, 0.6, 0.71, 0.93, 1.0, 1.37, 2.6, 5.1}) {
        double energy[2] = {0, 0};
        for (const bool filtered : {false, true}) {
            PatternSettings pattern;
            pattern.frequency = periods_a_pixel / pixel_m;
            pattern.filtered = filtered;
            std::vector<double> samples(static_cast<std::size_t>(size) * per_pixel);
            for (int shift = 0; shift < per_pixel; ++shift) {
                const std::vector<double> row = row_of(pattern, static_cast<double>(shift) / per_pixel);
                for (int x = 0; x < size; ++x)
                    samples[static_cast<std::size_t>(x * per_pixel + shift)] = row[static_cast<std::size_t>(x)];
            }
            energy[filtered ? 1 : 0] = energy_above_nyquist(samples, per_pixel);
        }
        EXPECT_GT(energy[0], 0);
        EXPECT_LE(energy[1], 0.01 * energy[0]) << periods_a_pixel << " periods a pixel";
    }
}

TEST_F(SurfacePattern, IsAsTheSumOverThePixelSays) {
    struct Expected {
        PatternKind kind;
        double tolerance;
        int side;  // of the sum's points
    };
    // The square wave is exact but for half floats and the sum's own steps; a checker's two waves go together where a
    // pixel is long across both, and octaves and bent waves are filtered as if they were straight.
    for (const Expected& expected : {Expected{PatternKind::square_wave, 2e-3, 128},
                                     Expected{PatternKind::checker, 0.01, 64}, Expected{PatternKind::noise, 0.03, 16},
                                     Expected{PatternKind::wood, 0.06, 16}, Expected{PatternKind::marble, 0.06, 16}}) {
        for (const double periods_a_pixel : {0.02, 0.1, 0.3, 0.8}) {
            PatternSettings pattern;
            pattern.kind = expected.kind;
            pattern.frequency = periods_a_pixel / pixel_m;
            pattern.direction = {0.8, 0.5, 0};
            pattern.share = 0.4;
            const ImageF image = drawn(pattern, 0);
            double worst = 0, sum2 = 0;
            int count = 0;
            for (int y = 3; y < size; y += 6) {
                for (int x = 3; x < size; x += 6) {
                    const auto at = [&](double right, double down) {
                        return Vector3d((x + right - size / 2) * pixel_m, -(y + down - size / 2) * pixel_m, 0);
                    };
                    const double error = image.at(x, y) - filtered_pattern(pattern, at, expected.side).x();
                    worst = std::max(worst, std::abs(error));
                    sum2 += error * error;
                    ++count;
                }
            }
            EXPECT_LT(std::sqrt(sum2 / count), expected.tolerance)
                << static_cast<int>(expected.kind) << ", " << periods_a_pixel << " periods a pixel, worst " << worst;
        }
    }
}

TEST_F(SurfacePattern, LayersAreTheConvexRecursion) {
    Model square = make_square(1);
    square.materials[0].base_color = {0.2F, 0.5F, 0.8F, 1};
    SurfacePictures pictures{.settings = {}, .heights = {}, .layers = {}};
    Vector3d expected(0.2, 0.5, 0.8);
    for (int n = 1; n <= 5; ++n) {
        Image8 picture(2, 2, 4);
        const std::array<std::uint8_t, 4> codes{
            static_cast<std::uint8_t>(40 * n), static_cast<std::uint8_t>(250 - 30 * n),
            static_cast<std::uint8_t>(n % 2 == 0 ? 20 : 220), static_cast<std::uint8_t>(255 - 20 * n)};
        for (int i = 0; i < 4; ++i) std::ranges::copy(codes, picture.pixel(i % 2, i / 2));
        const double alpha = 0.3 + 0.1 * n;
        pictures.settings.layers.push_back({.texture = "layer", .alpha = alpha, .uv_scale = 1.0 * n});
        pictures.layers.push_back(picture);
        // MT(n) = T(n)·a + MT(n−1)·(1−a)
        const double a = alpha * codes[3] / 255;
        for (int c = 0; c < 3; ++c)
            expected[c] = linear_from_srgb_code(codes[static_cast<std::size_t>(c)] / 255.0) * a + expected[c] * (1 - a);
        const ImageF image = drawn(pictures, square, 0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(size / 2, size / 2, c), expected[c], 2e-3) << n;  // sRGB to half a code
    }
}

}  // namespace
}  // namespace matchlight
