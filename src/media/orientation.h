// Stored pictures turned upright.
#pragma once

#include <algorithm>

#include "core/image.h"

namespace matchlight {

/// The stored image turned and mirrored as EXIF orientation 2..8 asks (JEITA CP-3451, tag 274).
template <class Sample>
Image<Sample> oriented(Image<Sample> stored, int orientation) {
    if (orientation < 2 || orientation > 8) return stored;
    const bool transposed = orientation >= 5;
    const int width = transposed ? stored.height() : stored.width();
    const int height = transposed ? stored.width() : stored.height();
    Image<Sample> shown(width, height, stored.channels());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            int sx = transposed ? y : x;
            int sy = transposed ? x : y;
            if (orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8)
                sx = stored.width() - 1 - sx;
            if (orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7)
                sy = stored.height() - 1 - sy;
            std::copy_n(stored.pixel(sx, sy), stored.channels(), shown.pixel(x, y));
        }
    }
    return shown;
}

}  // namespace matchlight
