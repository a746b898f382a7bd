// Pictures as data URLs.
#include "report/embedded_png.h"

#include <cassert>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base64.h"

namespace matchlight {

std::string embedded_png(const Image8& picture, int most_width_px) {
    assert(picture.channels() == 1 || picture.channels() == 3);
    assert(!picture.empty() && most_width_px > 0);
    const int channels = picture.channels();
    cv::Mat pixels(picture.height(), picture.width(), channels == 3 ? CV_8UC3 : CV_8UC1);
    for (int y = 0; y < picture.height(); ++y) {
        std::uint8_t* out = pixels.ptr<std::uint8_t>(y);
        for (int x = 0; x < picture.width(); ++x) {
            // OpenCV keeps blue first.
            for (int c = 0; c < channels; ++c) out[channels * x + c] = picture.at(x, y, channels - 1 - c);
        }
    }
    if (pixels.cols > most_width_px) {
        const double scale = static_cast<double>(most_width_px) / pixels.cols;
        cv::resize(pixels, pixels, {}, scale, scale, cv::INTER_AREA);
    }
    std::vector<std::uint8_t> png;
    if (!cv::imencode(".png", pixels, png)) throw std::runtime_error("a picture of the report cannot be encoded");
    return "data:image/png;base64," + base64(png);
}

}  // namespace matchlight
