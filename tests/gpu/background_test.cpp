// The background of scenes without footage: what a pixel shows is the mean of the light it sees.
#include "render/background.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <unistd.h>

#include "core/error.h"
#include "core/transfer.h"
#include "gl_fixture.h"
#include "media/image_io.h"
#include "render/effects/bokeh.h"
#include "render_scene.h"

namespace matchlight {
namespace {

class BackgroundTest : public GlTest {
protected:
    BackgroundTest() { warnings_.set_quiet(true); }

    ImageF draw(const Background& background, const BackgroundView& view) {
        RenderGraph graph;
        graph.begin_frame(view.width, view.height);
        const GraphTexture drawn = background.add(graph, shaders_, view);
        graph.output(drawn);
        graph.run();
        return graph.texture(drawn).read<float>({0, 0, view.width, view.height}, 3);
    }
    ImageF draw_sky(const Probe& probe, const BackgroundView& view) {
        return draw(Background({.probe = true, .color = {}, .image = {}}, probe, view.width, view.height, warnings_),
                    view);
    }

    ShaderLibrary shaders_;
    Warnings warnings_;
};

BackgroundView view_towards(const Eigen::Vector3d& forward, int size, double fov_deg) {
    BackgroundView view;
    view.width = view.height = size;
    view.fx = view.fy = size / 2.0 / std::tan(fov_deg / 2 * std::numbers::pi / 180);
    view.cx = view.cy = (size - 1) / 2.0;
    view.camera_from_world = camera_looking_along({4, 5, 6}, forward);  // the sky is as far from everywhere
    return view;
}

Eigen::Vector3d direction_of(const BackgroundView& view, double x, double y) {
    const Eigen::Vector3d in_camera((x - view.cx) / view.fx, (y - view.cy) / view.fy, 1);
    return (view.camera_from_world.linear().transpose() * in_camera).normalized();
}

Probe noisy_probe(int width) {
    std::mt19937 generator(3);
    std::exponential_distribution<double> noise;
    return test::make_probe(width, [&](const Eigen::Vector3d&) {
        return Eigen::Vector3d(noise(generator), noise(generator), noise(generator));
    });
}

TEST_F(BackgroundTest, ShowsTheProbeItselfWhereItIsCoarser) {
    Probe probe = noisy_probe(64);
    probe.latlong.at(20, 10, 0) = 1e9F;  // beyond what half floats hold
    // Towards the seam at world −y, between texels, and to the horizon in between: no direction is special.
    for (const Eigen::Vector3d& forward : {Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0.6, 0.48, 0.64)}) {
        const BackgroundView view = view_towards(forward, 48, 40);
        const ImageF picture = draw_sky(probe, view);
        for (int y = 0; y < view.height; ++y) {
            for (int x = 0; x < view.width; ++x) {
                const Eigen::Vector3d expected = probe.radiance(direction_of(view, x, y));
                for (int c = 0; c < 3; ++c) {
                    // Single precision places a pixel to 1e-5 texels or so, across differences of the size of the
                    // light.
                    ASSERT_NEAR(picture.at(x, y, c), expected[c], 2e-4 * (1 + expected[c])) << x << ' ' << y;
                }
            }
        }
    }
}

TEST_F(BackgroundTest, IsEvenUnderEvenLightInEveryDirection) {
    for (const Eigen::Vector3d& forward :
         {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 0, 0)}) {
        const ImageF picture = draw_sky(test::uniform_probe(0.7), view_towards(forward, 33, 100));
        for (const float value : picture.samples()) ASSERT_NEAR(value, 0.7, 1e-6);
    }
}

TEST_F(BackgroundTest, AveragesOverThePixelWhereTheProbeIsFiner) {
    // Stripes of one texel and a smooth slope: 512 columns in 90° of view over 16 pixels are 8 a pixel.
    const Probe probe = test::make_probe(512, [](const Eigen::Vector3d& d) {
        const int column = static_cast<int>(std::floor(latlong_pixel(d, 512, 256).x() + 0.5));
        return Eigen::Vector3d(column % 2, 1 + d.z(), 1 + 0.5 * d.x());
    });
    const BackgroundView view = view_towards(Eigen::Vector3d::UnitY(), 16, 90);
    const ImageF picture = draw_sky(probe, view);
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            const Eigen::Vector3d d = direction_of(view, x, y);
            EXPECT_NEAR(picture.at(x, y, 0), 0.5, 0.02);
            EXPECT_NEAR(picture.at(x, y, 1), 1 + d.z(), 0.01);
            EXPECT_NEAR(picture.at(x, y, 2), 1 + 0.5 * d.x(), 0.01);
        }
    }
}

TEST_F(BackgroundTest, KeepsTheEnergyOfASmallSun) {
    // A sun of one texel, wherever it stands between the pixels, however many of them it covers: its light over the
    // picture is that of the probe. Taps on a grid with steps of s texels miss 2·sinc²(1/s) of a bilinear texel at the
    // most, each way: 3 % for the half-texel steps here, 5 % at 0.55.
    Probe probe{ImageF(1024, 512, 3)};
    const int row = 230, column = 540;
    probe.latlong.at(column, row, 0) = 1e4F;
    const Eigen::Vector3d towards = latlong_direction(column, row, 1024, 512);
    const double pi = std::numbers::pi;
    const double solid_angle = (std::cos(row * pi / 512) - std::cos((row + 1) * pi / 512)) * 2 * pi / 1024;
    for (const int size : {20, 29, 41, 64, 113, 300}) {
        for (const double aside : {0.0, 0.004, 0.009}) {
            const Eigen::Vector3d forward = (towards + aside * Eigen::Vector3d(1, 0.3, 0.7)).normalized();
            const BackgroundView view = view_towards(forward, size, 40);
            const ImageF picture = draw_sky(probe, view);
            double sum = 0;
            for (int y = 0; y < size; ++y) {
                for (int x = 0; x < size; ++x) {
                    const double cosine = direction_of(view, x, y).dot(forward);
                    sum += picture.at(x, y, 0) * std::pow(cosine, 3) / (view.fx * view.fy);  // a pixel's solid angle
                }
            }
            EXPECT_NEAR(sum / (1e4 * solid_angle), 1, 0.11) << size << " pixels, aside by " << aside;
        }
    }
}

TEST_F(BackgroundTest, ShowsAColourThroughTheGain) {
    BackgroundView view = view_towards(Eigen::Vector3d::UnitX(), 5, 40);
    view.gain = Eigen::Vector3d(2, 4, 8);
    const Background background({.probe = false, .color = std::array{0.5, 0.25, 1e6}, .image = {}}, {}, 5, 5,
                                warnings_);
    const ImageF picture = draw(background, view);
    EXPECT_EQ(picture.at(2, 2, 0), 1);
    EXPECT_EQ(picture.at(4, 0, 1), 1);
    EXPECT_EQ(picture.at(0, 4, 2), 8e6F);
}

TEST_F(BackgroundTest, ShowsAPictureAsItIs) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("matchlight_background_" + std::to_string(getpid()) + ".png");
    Image8 codes(3, 2, 3);
    for (std::size_t i = 0; i < codes.samples().size(); ++i) codes.samples()[i] = static_cast<std::uint8_t>(14 * i);
    write_png8(path, codes);
    const BackgroundSettings settings{.probe = false, .color = {}, .image = path};
    BackgroundView view = view_towards(Eigen::Vector3d::UnitX(), 3, 40);
    view.height = 2;
    const ImageF picture = draw(Background(settings, {}, 3, 2, warnings_), view);
    for (std::size_t i = 0; i < codes.samples().size(); ++i) {
        EXPECT_NEAR(picture.samples()[i], linear_from_srgb_code(codes.samples()[i] / 255.0), 1e-5);
    }
    EXPECT_THROW(Background(settings, {}, 4, 2, warnings_), InputError);
    std::filesystem::remove(path);
}

TEST_F(BackgroundTest, IsBlackWithoutSettings) {
    const BackgroundView view = view_towards(Eigen::Vector3d::UnitX(), 1, 40);
    EXPECT_EQ(draw(Background({}, {}, 1, 1, warnings_), view).at(0, 0, 1), 0);
}

EvenDisc disc_of(const BackgroundView& view, const BokehSettings& bokeh, double coc_px,
                 const BackgroundDefocusKnobs& knobs = {}) {
    return even_disc(bokeh, coc_px, {0, 0, view.width, view.height}, knobs);
}

/// The mean over the opening of what its points see along a pixel.
Eigen::Vector3d through_the_lens(const Probe& probe, const BackgroundView& view, const Eigen::Vector2d& pixel,
                                 const BokehSettings& bokeh, double coc_px) {
    constexpr int steps = 80;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (int i = 0; i < steps * steps; ++i) {
        const int column = i % steps, row = i / steps;
        const Eigen::Vector2d point((2 * column + 1.0) / steps - 1, (2 * row + 1.0) / steps - 1);
        if (bokeh_distance(bokeh, point) > 1) continue;
        // Light from beyond the focus shows the opening upright: what this point passes comes from the other side.
        const Eigen::Vector2d from = pixel - coc_px / 2 * point;
        sum += probe.radiance(direction_of(view, from.x(), from.y()));
        ++count;
    }
    return sum / count;
}

TEST_F(BackgroundTest, IsBlurredAsTheLensDoes) {
    // Texels of 5 pixels, and noise from texel to texel: edges everywhere.
    const Probe probe = noisy_probe(64);
    BackgroundView view = view_towards({0.6, 0.48, 0.64}, 48, 50);
    for (const BokehSettings& bokeh : {BokehSettings{}, BokehSettings{.blades = 3, .rotation_deg = 25}}) {
        for (const double coc_px : {2.0, 7.0, 20.0, 45.0}) {
            view.defocus = disc_of(view, bokeh, coc_px);
            const ImageF picture = draw_sky(probe, view);
            double error = 0, contrast = 0;
            int count = 0;
            for (int y = 1; y < 48; y += 6) {
                for (int x = 1; x < 48; x += 6) {
                    const Eigen::Vector3d expected = through_the_lens(probe, view, {x, y}, bokeh, coc_px);
                    error += std::pow(picture.at(x, y, 1) - expected[1], 2);
                    ++count;
                    contrast += std::pow(probe.radiance(direction_of(view, x, y))[1] - expected[1], 2);
                }
            }
            // Of the noise' deviation of 1; nine texels hold a disc of two pixels to a tenth of a pixel.
            EXPECT_LT(std::sqrt(error / count), 0.03) << coc_px << " px, " << bokeh.blades;
            EXPECT_TRUE(coc_px < 5 || error < 0.01 * contrast) << coc_px << " px, " << bokeh.blades;
        }
    }
}

TEST_F(BackgroundTest, ABlurredSunKeepsItsLightAndTheShapeOfTheOpening) {
    // One texel of 1e5, a pixel or so wide, at the middle of the frame.
    const BackgroundView sharp = view_towards(Eigen::Vector3d::UnitY(), 96, 30);
    const Eigen::Vector2d at = latlong_pixel(direction_of(sharp, 48, 48), 1024, 512);
    Probe probe = test::make_probe(1024, [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, 0); });
    for (int c = 0; c < 3; ++c)
        probe.latlong.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())), c) = 1e5F;
    const auto sum_of = [](const ImageF& picture) {
        double sum = 0;
        for (const float value : picture.samples()) sum += value;
        return sum;
    };
    const double whole = sum_of(draw_sky(probe, sharp));
    ASSERT_GT(whole, 1e5);
    for (const double texels : {3.0, 8.0}) {
        for (const double coc_px : {3.0, 15.0, 40.0, 55.0}) {
            BackgroundView view = sharp;
            view.defocus = disc_of(view, {}, coc_px, {.disc_texels = texels});
            const ImageF picture = draw_sky(probe, view);
            EXPECT_NEAR(sum_of(picture) / whole, 1, 1e-3) << coc_px << " px on " << texels;
            double beside = 0;
            for (int y = 0; y < 96; ++y) {
                for (int x = 0; x < 96; ++x) {
                    // The sun's own extent, and a texel.
                    const double reach_px = coc_px / 2 + 4 + 2.0 * view.defocus->texel_px;
                    if (std::hypot(x - 48, y - 48) > reach_px) beside += picture.at(x, y, 0);
                }
            }
            EXPECT_LT(beside / whole, 1e-6) << coc_px;
        }
    }
}

TEST_F(BackgroundTest, CirclesOfLessThanAQuarterPixelAreNone) {
    const Probe probe = noisy_probe(512);
    BackgroundView view = view_towards({0.6, 0.48, 0.64}, 48, 50);
    const ImageF sharp = draw_sky(probe, view);
    view.defocus = disc_of(view, {}, 0.99 * least_coc_px);
    EXPECT_TRUE(std::ranges::equal(sharp.samples(), draw_sky(probe, view).samples()));
    view.defocus = disc_of(view, {}, 4);
    EXPECT_FALSE(std::ranges::equal(sharp.samples(), draw_sky(probe, view).samples()));
}

TEST_F(BackgroundTest, ACircleWiderThanTheFrameIsItsMean) {
    const Probe probe = noisy_probe(64);
    BackgroundView view = view_towards({0.6, 0.48, 0.64}, 33, 60);
    for (const double coc_px : {200.0, 1e6}) {
        view.defocus = disc_of(view, {}, coc_px);
        const ImageF picture = draw_sky(probe, view);
        const float middle = picture.at(16, 16, 1);
        for (const float value : picture.samples()) ASSERT_TRUE(std::isfinite(value));
        // Of thousands of texels of the probe.
        EXPECT_NEAR(middle, 1, 0.2);
        EXPECT_NEAR(picture.at(0, 0, 1), middle, 0.2);
    }
}

}  // namespace
}  // namespace matchlight
