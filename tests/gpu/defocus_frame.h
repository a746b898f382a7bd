// A layer out of focus made up on the CPU, and how pictures are compared.
#pragma once

#include <cmath>

#include "report/defocus_reference.h"

namespace matchlight::test {

/// A square in focus before a slope whose circles grow from far before the focus to far behind it, with a highlight and
/// a translucent band; the frame's left part is empty.
inline DefocusImages slope_and_square(int width, int height, double widest_coc_px) {
    DefocusImages images(width, height);
    for (int y = height / 8; y < height * 7 / 8; ++y) {
        for (int x = width / 4; x < width; ++x) {
            const double t = static_cast<double>(x - width / 4) / (width - width / 4 - 1);
            // A 64th of a pixel is exact in run_defocus()'s depths.
            images.set(x, y, (x / 3 + y / 5) % 2 == 0 ? 0.2 : 0.9, std::round(64 * widest_coc_px * (2 * t - 1)) / 64);
            if (y < height / 4) {
                for (int c = 0; c < 4; ++c) images.light.at(x, y, c) *= 0.5;
            }
        }
    }
    for (int y = height / 2; y < height * 3 / 4; ++y) {
        for (int x = width * 5 / 8; x < width * 3 / 4; ++x) images.set(x, y, 0.6, 0);
    }
    images.set(width * 2 / 5, height / 3, 1e3, images.coc_px.at(width * 2 / 5, height / 3));
    return images;
}

/// Greatest difference, relative to what is there where that is more than 1.
inline double worst_difference(const ImageF& result, const ImageD& expected) {
    double worst = 0;
    for (std::size_t i = 0; i < result.samples().size(); ++i) {
        const double difference = std::abs(result.samples()[i] - expected.samples()[i]);
        worst = std::max(worst, difference / std::max(1.0, expected.samples()[i]));
        if (!std::isfinite(result.samples()[i])) return HUGE_VAL;
    }
    return worst;
}

template <class Picture>
double sum_of(const Picture& picture, int channel) {
    double sum = 0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) sum += picture.at(x, y, channel);
    }
    return sum;
}

}  // namespace matchlight::test
