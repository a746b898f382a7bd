// Magma (Smith & van der Walt, "A Better Default Colormap for Matplotlib", SciPy 2015), by OpenCV's table.
#include "report/flip_colors.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace matchlight {

Image8 flip_colors(const ImageF& error_map) {
    assert(error_map.channels() == 1);
    cv::Mat index(error_map.height(), error_map.width(), CV_8U);
    for (int y = 0; y < error_map.height(); ++y) {
        for (int x = 0; x < error_map.width(); ++x) {
            const float error = std::clamp(error_map.at(x, y), 0.0f, 1.0f);
            index.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(255 * error));
        }
    }
    cv::Mat bgr;
    cv::applyColorMap(index, bgr, cv::COLORMAP_MAGMA);
    Image8 colors(error_map.width(), error_map.height(), 3);
    for (int y = 0; y < bgr.rows; ++y) {
        for (int x = 0; x < bgr.cols; ++x) {
            const auto& pixel = bgr.at<cv::Vec3b>(y, x);
            for (int c = 0; c < 3; ++c) colors.at(x, y, c) = pixel[2 - c];
        }
    }
    return colors;
}

}  // namespace matchlight
