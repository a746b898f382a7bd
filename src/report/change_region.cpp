// Threshold, median and dilation by OpenCV.
#include "report/change_region.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

namespace matchlight {

Image8 change_region(const Image8& plate, const Image8& with_objects) {
    assert(plate.bounds() == with_objects.bounds() && plate.channels() == 3 && with_objects.channels() == 3);
    constexpr int noise_codes = 10;  // several deviations of a noisy camera's grain
    constexpr int median_px = 5;
    constexpr int reach_px = 15;
    cv::Mat changed(plate.height(), plate.width(), CV_8U);
    for (int y = 0; y < plate.height(); ++y) {
        for (int x = 0; x < plate.width(); ++x) {
            const std::uint8_t* p = plate.pixel(x, y);
            const std::uint8_t* q = with_objects.pixel(x, y);
            const int difference = std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
            changed.at<std::uint8_t>(y, x) = difference > noise_codes ? 255 : 0;
        }
    }
    cv::medianBlur(changed, changed, median_px);
    cv::dilate(changed, changed, cv::Mat::ones(reach_px, reach_px, CV_8U));
    Image8 region(plate.width(), plate.height(), 1);
    for (int y = 0; y < changed.rows; ++y) {
        std::copy_n(changed.ptr<std::uint8_t>(y), changed.cols, region.pixel(0, y));
    }
    return region;
}

}  // namespace matchlight
