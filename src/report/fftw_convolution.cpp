// One transform of each channel, padded so that nothing comes round.
#include "report/fftw_convolution.h"

#include <cassert>
#include <complex>
#include <vector>

#include <fftw3.h>

namespace matchlight {
namespace {

using Complex = std::complex<double>;

/// A plane of real numbers, its transform, and the plans between them.
class TransformedPlane {
public:
    TransformedPlane(int width, int height)
        : width_(width),
          height_(height),
          places_(static_cast<std::size_t>(width) * height),
          spectrum_(static_cast<std::size_t>(width / 2 + 1) * height),
          forward_(fftw_plan_dft_r2c_2d(height, width, places_.data(), frequencies(), FFTW_ESTIMATE)),
          back_(fftw_plan_dft_c2r_2d(height, width, frequencies(), places_.data(), FFTW_ESTIMATE)) {}
    ~TransformedPlane() {
        fftw_destroy_plan(forward_);
        fftw_destroy_plan(back_);
    }
    TransformedPlane(const TransformedPlane&) = delete;
    TransformedPlane& operator=(const TransformedPlane&) = delete;

    /// Negative places count from the far end.
    double& at(int x, int y) {
        const int column = (x + width_) % width_;
        const int row = (y + height_) % height_;
        return places_[static_cast<std::size_t>(row) * width_ + column];
    }
    void transform() { fftw_execute(forward_); }
    void transform_back() { fftw_execute(back_); }
    std::vector<Complex>& spectrum() { return spectrum_; }

private:
    fftw_complex* frequencies() { return reinterpret_cast<fftw_complex*>(spectrum_.data()); }

    int width_, height_;
    std::vector<double> places_;
    std::vector<Complex> spectrum_;
    fftw_plan forward_, back_;
};

}  // namespace

Image<double> convolve_fftw(const Image<double>& picture, const Image<double>& kernel) {
    assert(kernel.width() % 2 == 1 && kernel.height() % 2 == 1 && kernel.channels() == picture.channels());
    // What the kernel carries further than the picture is wide reaches nothing in it.
    const int across = std::min(kernel.width() / 2, picture.width() - 1);
    const int down = std::min(kernel.height() / 2, picture.height() - 1);
    const int width = picture.width() + across;
    const int height = picture.height() + down;
    Image<double> result(picture.width(), picture.height(), picture.channels());
    for (int c = 0; c < picture.channels(); ++c) {
        TransformedPlane light(width, height);
        TransformedPlane spread(width, height);
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) light.at(x, y) = picture.at(x, y, c);
        }
        for (int y = -down; y <= down; ++y) {
            for (int x = -across; x <= across; ++x) {
                spread.at(x, y) = kernel.at(kernel.width() / 2 + x, kernel.height() / 2 + y, c);
            }
        }
        light.transform();
        spread.transform();
        for (std::size_t i = 0; i < light.spectrum().size(); ++i) light.spectrum()[i] *= spread.spectrum()[i];
        light.transform_back();
        const double factor = 1.0 / (static_cast<double>(width) * height);
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) result.at(x, y, c) = light.at(x, y) * factor;
        }
    }
    return result;
}

}  // namespace matchlight
