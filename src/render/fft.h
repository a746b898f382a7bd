// Fourier transforms of pictures on the GPU, and convolution by them.
//
// Compute shaders (shaders/fft), one pass an axis, in 32-bit floats. Sign and scale are FFTW's: no factor forwards,
// 1 / (width · height) backwards. Sides are powers of two.
#pragma once

#include "core/image.h"
#include "gl/objects.h"
#include "gl/shader_library.h"

namespace matchlight {

/// The transform of a real RGB picture: columns 0 … width / 2, since the others mirror them.
struct RgbSpectrum {
    RgbSpectrum(int width, int height);

    int width = 0;  // of the picture
    int height = 0;
    Texture2D re, im;  // RGBA32F, (width / 2 + 1) × height
};

/// A part of a texture and the place of its first texel in the transform; all else there is zero.
struct FftSource {
    const Texture2D* texture = nullptr;
    Region texels;
    int x = 0;
    int y = 0;
};

/// Transforms of one size.
class Fft2d {
public:
    static constexpr int least_side = 2;
    static constexpr int most_side = 2048;
    /// The least power of two that holds so many places, from least_side; beyond most_side there is none: 0.
    static int side_for(int places);

    /// `conditional`: only where the condition bound for shaders (gl/condition.h) is met does anything happen.
    Fft2d(ShaderLibrary& shaders, int width, int height, bool conditional = false);

    void forward(const FftSource& source, RgbSpectrum& spectrum);
    /// Fills `picture`'s first texels, as many as both hold. Uses up the spectrum.
    void back(RgbSpectrum& spectrum, const Texture2D& picture);

    struct Convolution {
        FftSource source;
        const Texture2D* kernel = nullptr;  // the real part of its spectrum: it is even
        double factor = 1;
        const Texture2D* picture = nullptr;  // gets places (0, 0) … size of the transform
        int width = 0, height = 0;
    };
    /// source ∗ kernel, circular over the transform's size. `scratch` is overwritten.
    void convolve(const Convolution& convolution, RgbSpectrum& scratch);

    int width() const { return width_; }
    int height() const { return height_; }
    /// Moved by a convolution beside its source and its picture: the spectrum four times, the kernel once.
    double bytes(const Convolution& convolution) const;

private:
    struct Columns {
        int first_row = 0, rows_in = 0, rows_out = 0;
        const Texture2D* kernel = nullptr;
        double factor = 1;
    };
    ShaderDefines defines(int length) const;
    void rows_forward(const FftSource& source, RgbSpectrum& spectrum);
    void columns(const std::string& direction, const Columns& columns, RgbSpectrum& spectrum);
    void rows_back(RgbSpectrum& spectrum, const Texture2D& picture, const Region& wanted, double factor);

    ShaderLibrary* shaders_;
    int width_, height_;
    bool conditional_;
    Buffer row_twiddles_, column_twiddles_;
};

}  // namespace matchlight
