// A camera place from which a mirror ball was photographed, and all that is found out about it.
#include "lighting/ball_view.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

Eigen::Vector3d sample_rgb(const ImageF& image, const Eigen::Vector2d& pixel) {
    const double x = std::clamp(pixel.x(), 0.0, image.width() - 1.0);
    const double y = std::clamp(pixel.y(), 0.0, image.height() - 1.0);
    const int left = std::min(static_cast<int>(x), std::max(0, image.width() - 2));
    const int top = std::min(static_cast<int>(y), std::max(0, image.height() - 2));
    const int right = std::min(left + 1, image.width() - 1), bottom = std::min(top + 1, image.height() - 1);
    const double across = x - left, down = y - top;
    const auto at = [&](int px, int py) {
        return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(image.pixel(px, py)).cast<double>());
    };
    return (at(left, top) * (1 - across) + at(right, top) * across) * (1 - down) +
           (at(left, bottom) * (1 - across) + at(right, bottom) * across) * down;
}

}  // namespace matchlight
