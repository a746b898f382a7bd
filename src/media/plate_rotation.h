// Between the stored picture and the displayed one, which the file turns by a multiple of 90°.
#pragma once

#include <algorithm>

#include "core/image.h"

namespace matchlight {

/// `rotation_deg` is the clockwise turn from stored to displayed.
struct PlateRotation {
    int rotation_deg = 0;
    int stored_width = 0, stored_height = 0;

    int stored_x(int x, int y) const {
        switch (rotation_deg) {
            case 90:
                return y;
            case 180:
                return stored_width - 1 - x;
            case 270:
                return stored_width - 1 - y;
            default:
                return x;
        }
    }
    int stored_y(int x, int y) const {
        switch (rotation_deg) {
            case 90:
                return stored_height - 1 - x;
            case 180:
                return stored_height - 1 - y;
            case 270:
                return x;
            default:
                return y;
        }
    }
    Region stored(const Region& shown) const {
        const int x0 = stored_x(shown.x, shown.y), y0 = stored_y(shown.x, shown.y);
        const int last_x = shown.x + shown.width - 1, last_y = shown.y + shown.height - 1;
        const int x1 = stored_x(last_x, last_y), y1 = stored_y(last_x, last_y);
        return {std::min(x0, x1), std::min(y0, y1), std::abs(x1 - x0) + 1, std::abs(y1 - y0) + 1};
    }

    /// Pixels of the displayed region `shown` from those of `stored(shown)`.
    template <class Sample>
    Image<Sample> displayed(Image<Sample> image, const Region& shown) const {
        if (rotation_deg == 0) return image;
        const Region from = stored(shown);
        Image<Sample> result(shown.width, shown.height, image.channels());
        for (int y = 0; y < shown.height; ++y) {
            for (int x = 0; x < shown.width; ++x) {
                const int sx = stored_x(shown.x + x, shown.y + y) - from.x;
                const int sy = stored_y(shown.x + x, shown.y + y) - from.y;
                std::copy_n(image.pixel(sx, sy), image.channels(), result.pixel(x, y));
            }
        }
        return result;
    }
    /// The other way: pixels of `stored(shown)` from those of `shown`.
    template <class Sample>
    Image<Sample> to_stored(const Image<Sample>& image, const Region& shown) const {
        const Region to = stored(shown);
        Image<Sample> result(to.width, to.height, image.channels());
        for (int y = 0; y < shown.height; ++y) {
            for (int x = 0; x < shown.width; ++x) {
                const int sx = stored_x(shown.x + x, shown.y + y) - to.x;
                const int sy = stored_y(shown.x + x, shown.y + y) - to.y;
                std::copy_n(image.pixel(x, y), image.channels(), result.pixel(sx, sy));
            }
        }
        return result;
    }
};

}  // namespace matchlight
