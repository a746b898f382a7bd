// Pictures for the tests of the metrics: read by OpenCV, or made up.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <random>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "core/image.h"

namespace matchlight::test {

inline Image8 read_picture(const std::filesystem::path& path) {
    const cv::Mat bgr = cv::imread(path.string(), cv::IMREAD_COLOR);
    if (bgr.empty()) throw std::runtime_error(path.string() + " cannot be read");
    Image8 image(bgr.cols, bgr.rows, 3);
    for (int y = 0; y < bgr.rows; ++y) {
        for (int x = 0; x < bgr.cols; ++x) {
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = bgr.at<cv::Vec3b>(y, x)[2 - c];
        }
    }
    return image;
}

inline Image8 flat_picture(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    Image8 image(width, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            image.at(x, y, 0) = r;
            image.at(x, y, 1) = g;
            image.at(x, y, 2) = b;
        }
    }
    return image;
}

inline Image8 noise_picture(int width, int height, unsigned seed) {
    Image8 image(width, height, 3);
    std::mt19937 random(seed);
    for (std::uint8_t& sample : image.samples()) sample = static_cast<std::uint8_t>(random() >> 24);
    return image;
}

/// The part of a picture that starts at (left, top).
inline Image8 cropped(const Image8& image, int left, int top) {
    Image8 part(image.width() - left, image.height() - top, image.channels());
    for (int y = 0; y < part.height(); ++y) {
        std::copy_n(image.pixel(left, top + y), part.row(y).size(), part.pixel(0, y));
    }
    return part;
}

}  // namespace matchlight::test
