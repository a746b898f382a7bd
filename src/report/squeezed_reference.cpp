// Means and interpolation, texel by texel.
#include "report/squeezed_reference.h"

#include <algorithm>

#include "core/parallel.h"

namespace matchlight {

ImageD squeezed(const ImageD& image, int width, int height) {
    ImageD small(width, height, 3);
    const double wide = double(image.width()) / width, high = double(image.height()) / height;
    parallel_for(height, [&](int v) {
        for (int u = 0; u < width; ++u) {
            for (int y = static_cast<int>(v * high); y < std::min<double>(image.height(), (v + 1) * high); ++y) {
                const double rows = std::min(y + 1.0, (v + 1) * high) - std::max<double>(y, v * high);
                for (int x = static_cast<int>(u * wide); x < std::min<double>(image.width(), (u + 1) * wide); ++x) {
                    const double columns = std::min(x + 1.0, (u + 1) * wide) - std::max<double>(x, u * wide);
                    for (int c = 0; c < 3; ++c) {
                        small.at(u, v, c) += rows * columns / (wide * high) * image.at(x, y, c);
                    }
                }
            }
        }
    });
    return small;
}

void add_magnified(const ImageD& image, double weight, ImageD& sum) {
    parallel_for(sum.height(), [&](int y) {
        const double v = std::clamp((y + 0.5) * image.height() / sum.height() - 0.5, 0.0, image.height() - 1.0);
        const int top = static_cast<int>(v), bottom = std::min(top + 1, image.height() - 1);
        for (int x = 0; x < sum.width(); ++x) {
            const double u = std::clamp((x + 0.5) * image.width() / sum.width() - 0.5, 0.0, image.width() - 1.0);
            const int left = static_cast<int>(u), right = std::min(left + 1, image.width() - 1);
            for (int c = 0; c < 3; ++c) {
                const double above = image.at(left, top, c) * (1 - (u - left)) + image.at(right, top, c) * (u - left);
                const double below =
                    image.at(left, bottom, c) * (1 - (u - left)) + image.at(right, bottom, c) * (u - left);
                sum.at(x, y, c) += weight * (above * (1 - (v - top)) + below * (v - top));
            }
        }
    });
}

}  // namespace matchlight
