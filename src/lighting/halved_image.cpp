// An image at half its size.
#include "lighting/halved_image.h"

namespace matchlight {

ImageF halved(const ImageF& image, int width, int height) {
    ImageF half(width, height, image.channels());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                float sum = 0;
                for (int i = 0; i < 4; ++i) {
                    const int sx = 2 * x + i % 2, sy = 2 * y + i / 2;
                    if (image.bounds().contains(sx, sy)) sum += image.at(sx, sy, c);
                }
                half.at(x, y, c) = sum / 4;
            }
        }
    }
    return half;
}

}  // namespace matchlight
