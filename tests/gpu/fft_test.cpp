// Transforms on the GPU against FFTW in double precision.
#include "render/fft.h"

#include <array>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <fftw3.h>
#include <gtest/gtest.h>

#include "gl_fixture.h"

namespace matchlight {
namespace {

using Complex = std::complex<double>;

ImageF random_picture(int width, int height, int channels, unsigned seed) {
    ImageF picture(width, height, channels);
    std::mt19937 engine(seed);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (float& sample : picture.samples()) sample = uniform(engine);
    return picture;
}

Texture2D texture_of(const ImageF& picture) {
    Texture2D texture({.format = GL_RGBA32F, .width = picture.width(), .height = picture.height()});
    texture.upload(picture);
    return texture;
}

/// One channel's columns 0 … width / 2, every row.
std::vector<Complex> fftw_forward(const ImageF& picture, int channel) {
    const int width = picture.width(), height = picture.height();
    std::vector<double> in(static_cast<std::size_t>(width) * height);
    std::vector<Complex> out(static_cast<std::size_t>(width / 2 + 1) * height);
    const fftw_plan plan =
        fftw_plan_dft_r2c_2d(height, width, in.data(), reinterpret_cast<fftw_complex*>(out.data()), FFTW_ESTIMATE);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) in[static_cast<std::size_t>(y) * width + x] = picture.at(x, y, channel);
    }
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    return out;
}

class FftTest : public GlTest {
protected:
    static std::vector<Complex> channel_of(const RgbSpectrum& spectrum, int channel) {
        const ImageF re = spectrum.re.read<float>(spectrum.re.bounds(), 4);
        const ImageF im = spectrum.im.read<float>(spectrum.im.bounds(), 4);
        std::vector<Complex> values;
        for (int y = 0; y < re.height(); ++y) {
            for (int x = 0; x < re.width(); ++x) values.emplace_back(re.at(x, y, channel), im.at(x, y, channel));
        }
        return values;
    }

    ShaderLibrary shaders_;
};

double relative_rms(const std::vector<Complex>& truth, const std::vector<Complex>& test) {
    double error = 0, total = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        error += std::norm(test[i] - truth[i]);
        total += std::norm(truth[i]);
    }
    return std::sqrt(error / total);
}

class FftSizeTest : public FftTest, public testing::WithParamInterface<std::array<int, 2>> {};

TEST_P(FftSizeTest, AgreesWithFftwAndComesBack) {
    const auto [width, height] = GetParam();
    const ImageF picture = random_picture(width, height, 3, 7);
    const Texture2D texture = texture_of(picture);
    Fft2d fft(shaders_, width, height);
    RgbSpectrum spectrum(width, height);
    fft.forward({.texture = &texture, .texels = texture.bounds()}, spectrum);
    double energy = 0, spectral_energy = 0;
    for (int c = 0; c < 3; ++c) {
        const std::vector<Complex> truth = fftw_forward(picture, c);
        const std::vector<Complex> test = channel_of(spectrum, c);
        ASSERT_EQ(truth.size(), test.size());
        // Rounding grows with the root of the number of stages: 11 of them stay below 1e-6.
        EXPECT_LT(relative_rms(truth, test), 1e-6) << "channel " << c;
        const int half = width / 2 + 1;
        for (std::size_t i = 0; i < test.size(); ++i) {
            const int column = static_cast<int>(i) % half;
            spectral_energy += std::norm(test[i]) * (column == 0 || column == width / 2 ? 1 : 2);
        }
    }
    for (const float sample : picture.samples()) energy += static_cast<double>(sample) * sample;
    // Parseval: sums of squares agree but for the number of places.
    EXPECT_NEAR(spectral_energy / (static_cast<double>(width) * height), energy, 1e-6 * energy);

    const Texture2D back({.format = GL_RGBA32F, .width = width, .height = height});
    fft.back(spectrum, back);
    const ImageF returned = back.read<float>(back.bounds(), 3);
    double error = 0;
    for (std::size_t i = 0; i < returned.samples().size(); ++i) {
        error += std::pow(static_cast<double>(returned.samples()[i]) - picture.samples()[i], 2);
    }
    EXPECT_LT(std::sqrt(error / energy), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Sizes, FftSizeTest,
                         testing::Values(std::array{2, 2}, std::array{4, 2}, std::array{2, 4}, std::array{8, 16},
                                         std::array{16, 8}, std::array{32, 64}, std::array{64, 32},
                                         std::array{128, 256}, std::array{512, 128}, std::array{256, 512},
                                         std::array{1024, 64}, std::array{32, 1024}, std::array{2048, 16},
                                         std::array{8, 2048}),
                         [](const auto& case_) {
                             return std::to_string(case_.param[0]) + "x" + std::to_string(case_.param[1]);
                         });

}  // namespace
}  // namespace matchlight
