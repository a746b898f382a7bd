// Sizes, twiddle factors and dispatches of the transforms.
#include "render/fft.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace matchlight {
namespace {

// As the shaders name them.
constexpr GLuint twiddle_binding = 0;
constexpr GLuint re_image = 0;
constexpr GLuint im_image = 1;

/// exp(−2πi k / length), in double, rounded once.
Buffer make_twiddles(int length) {
    std::vector<float> twiddles;
    for (int k = 0; k < length; ++k) {
        const double angle = -2 * std::numbers::pi * k / length;
        twiddles.push_back(static_cast<float>(std::cos(angle)));
        twiddles.push_back(static_cast<float>(std::sin(angle)));
    }
    return Buffer(std::span<const float>(twiddles));
}

int even_above(int count) {
    return count + count % 2;
}

void bind_spectrum_images(const RgbSpectrum& spectrum, GLenum access) {
    spectrum.re.bind_image(re_image, access);
    spectrum.im.bind_image(im_image, access);
}

void dispatch(int groups) {
    glDispatchCompute(static_cast<GLuint>(groups), 1, 1);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                    GL_FRAMEBUFFER_BARRIER_BIT);
}

}  // namespace

RgbSpectrum::RgbSpectrum(int width_px, int height_px)
    : width(width_px),
      height(height_px),
      re({.format = GL_RGBA32F, .width = width_px / 2 + 1, .height = height_px}),
      im({.format = GL_RGBA32F, .width = width_px / 2 + 1, .height = height_px}) {}

int Fft2d::side_for(int places) {
    if (places > most_side) return 0;
    return std::max(least_side, static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(places, 1)))));
}

Fft2d::Fft2d(ShaderLibrary& shaders, int width, int height, bool conditional)
    : shaders_(&shaders),
      width_(width),
      height_(height),
      conditional_(conditional),
      row_twiddles_(make_twiddles(width)),
      column_twiddles_(make_twiddles(height)) {
    assert(side_for(width) == width && side_for(height) == height);
}

ShaderDefines Fft2d::defines(int length) const {
    ShaderDefines defines{{"LENGTH", std::to_string(length)}};
    if (conditional_) defines["CONDITIONAL"] = "1";
    return defines;
}

void Fft2d::rows_forward(const FftSource& source, RgbSpectrum& spectrum) {
    const Region& texels = source.texels;
    assert(source.x >= 0 && source.x + texels.width <= width_ && source.y >= 0 && source.y + texels.height <= height_);
    Program& program = shaders_->compute("fft/rows_forward.comp", defines(width_));
    program.use();
    program.bind_texture("source", 0, *source.texture);
    program.set("source_region", Eigen::Vector4i(texels.x, texels.y, texels.width, texels.height));
    program.set("source_place", Eigen::Vector2i(source.x, source.y));
    row_twiddles_.bind(GL_SHADER_STORAGE_BUFFER, twiddle_binding);
    bind_spectrum_images(spectrum, GL_WRITE_ONLY);
    dispatch(even_above(texels.height) / 2);
}

void Fft2d::columns(const std::string& direction, const Columns& columns, RgbSpectrum& spectrum) {
    ShaderDefines variant = defines(height_);
    variant[direction] = "1";
    Program& program = shaders_->compute("fft/columns.comp", variant);
    program.use();
    program.set("rows_in", Eigen::Vector2i(columns.first_row, columns.rows_in));
    program.set("rows_out", columns.rows_out);
    if (columns.kernel != nullptr) {
        program.bind_texture("kernel", 0, *columns.kernel);
        program.set("factor", columns.factor);
    }
    column_twiddles_.bind(GL_SHADER_STORAGE_BUFFER, twiddle_binding);
    bind_spectrum_images(spectrum, GL_READ_WRITE);
    dispatch(width_ / 2 + 1);
}

void Fft2d::rows_back(RgbSpectrum& spectrum, const Texture2D& picture, const Region& wanted, double factor) {
    Program& program = shaders_->compute("fft/rows_back.comp", defines(width_));
    program.use();
    program.bind_texture("spectrum_re", 0, spectrum.re);
    program.bind_texture("spectrum_im", 1, spectrum.im);
    program.set("picture_size", Eigen::Vector2i(wanted.width, wanted.height));
    program.set("factor", factor);
    row_twiddles_.bind(GL_SHADER_STORAGE_BUFFER, twiddle_binding);
    picture.bind_image(0, GL_WRITE_ONLY);
    dispatch(even_above(wanted.height) / 2);
}

void Fft2d::forward(const FftSource& source, RgbSpectrum& spectrum) {
    assert(spectrum.width == width_ && spectrum.height == height_);
    rows_forward(source, spectrum);
    columns("FORWARD", {.first_row = source.y, .rows_in = source.texels.height, .rows_out = height_}, spectrum);
}

void Fft2d::back(RgbSpectrum& spectrum, const Texture2D& picture) {
    assert(spectrum.width == width_ && spectrum.height == height_);
    const Region wanted = picture.bounds().intersected({0, 0, width_, height_});
    columns("BACK", {.first_row = 0, .rows_in = height_, .rows_out = even_above(wanted.height)}, spectrum);
    rows_back(spectrum, picture, wanted, 1.0 / (static_cast<double>(width_) * height_));
}

void Fft2d::convolve(const Convolution& convolution, RgbSpectrum& scratch) {
    assert(scratch.width == width_ && scratch.height == height_);
    const Region wanted{0, 0, convolution.width, convolution.height};
    assert(wanted.width <= width_ && wanted.height <= height_);
    rows_forward(convolution.source, scratch);
    columns("PRODUCT",
            {.first_row = convolution.source.y,
             .rows_in = convolution.source.texels.height,
             .rows_out = even_above(wanted.height),
             .kernel = convolution.kernel,
             .factor = convolution.factor / (static_cast<double>(width_) * height_)},
            scratch);
    rows_back(scratch, *convolution.picture, wanted, 1);
}

double Fft2d::bytes(const Convolution& convolution) const {
    constexpr double complex_rgb = 2 * 16;  // two RGBA32F textures
    const int half = width_ / 2 + 1;
    const double rows_in = even_above(convolution.source.texels.height);
    const double rows_out = even_above(convolution.height);
    const double spectrum = complex_rgb * half * 2 * (rows_in + rows_out);
    return spectrum + 16.0 * half * height_;
}

}  // namespace matchlight
