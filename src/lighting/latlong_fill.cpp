// Lat-long maps with pixels that nobody saw, filled from around them.
#include "lighting/latlong_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace matchlight {

void fill_unseen(ImageF& radiance, const ImageF& known) {
    std::vector<cv::Mat> light, weight;
    cv::Mat whole(radiance.height(), radiance.width(), CV_32FC3, radiance.samples().data());
    const cv::Mat mask(known.height(), known.width(), CV_32F, const_cast<float*>(known.samples().data()));
    weight.push_back(mask.clone());
    cv::Mat three;
    cv::merge(std::array{mask, mask, mask}, three);
    light.push_back(whole.mul(three));
    while (light.back().rows > 1) {
        cv::Mat smaller, smaller_weight;
        const cv::Size half(std::max(1, light.back().cols / 2), std::max(1, light.back().rows / 2));
        cv::resize(light.back(), smaller, half, 0, 0, cv::INTER_AREA);
        cv::resize(weight.back(), smaller_weight, half, 0, 0, cv::INTER_AREA);
        light.push_back(smaller);
        weight.push_back(smaller_weight);
    }
    cv::Mat coarse;
    for (std::size_t level = light.size(); level-- > 0;) {
        cv::Mat finer = light[level].clone();
        for (int y = 0; y < finer.rows; ++y) {
            for (int x = 0; x < finer.cols; ++x) {
                auto& value = finer.at<cv::Vec3f>(y, x);
                const float w = weight[level].at<float>(y, x);
                if (w > 0) {
                    value /= w;
                } else if (!coarse.empty()) {
                    value = coarse.at<cv::Vec3f>(y, x);
                }
            }
        }
        if (level == 0) {
            finer.copyTo(whole);
            return;
        }
        // A column on each side from the other, so that the seam is smooth.
        cv::Mat wide;
        cv::copyMakeBorder(finer, wide, 0, 0, 1, 1, cv::BORDER_WRAP);
        const double scale = static_cast<double>(light[level - 1].cols) / finer.cols;
        const int border = static_cast<int>(std::lround(scale));
        cv::resize(wide, wide, {light[level - 1].cols + 2 * border, light[level - 1].rows}, 0, 0, cv::INTER_LINEAR);
        coarse = wide(cv::Rect(border, 0, light[level - 1].cols, light[level - 1].rows)).clone();
    }
}

}  // namespace matchlight
