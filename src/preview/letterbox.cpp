// Shapes are kept: one factor for both sides.
#include "preview/letterbox.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

PictureSize displayed_size(int width, int height, double pixel_aspect) {
    return {std::max(1.0, std::round(width * pixel_aspect)), static_cast<double>(height)};
}

Eigen::Vector4f letterbox(const PictureSize& picture, int window_width, int window_height) {
    const double factor = std::min(window_width / picture.width, window_height / picture.height);
    const double width = std::max(1.0, std::round(picture.width * factor));
    const double height = std::max(1.0, std::round(picture.height * factor));
    const Eigen::Vector4d place(std::floor((window_width - width) / 2), std::floor((window_height - height) / 2), width,
                                height);
    return place.cast<float>();
}

Eigen::Vector2i fitted_window(const PictureSize& picture, const Eigen::Vector2i& screen, const Eigen::Vector2i& least) {
    const double factor = std::min({1.0, screen.x() / picture.width, screen.y() / picture.height});
    return {std::max(least.x(), static_cast<int>(std::lround(picture.width * factor))),
            std::max(least.y(), static_cast<int>(std::lround(picture.height * factor)))};
}

}  // namespace matchlight
