// The curve at every pixel, then the weights of every block.
#include "report/bright_reference.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace matchlight {
namespace {

constexpr double largest_half = 65504;

using Color = std::array<double, 3>;

/// NaN and less than nothing are dark; what is more than a half float holds is as much as it holds.
Color repaired(const float* light) {
    Color color{};
    for (std::size_t c = 0; c < 3; ++c) color[c] = light[c] > 0 ? std::min<double>(light[c], largest_half) : 0;
    return color;
}

Color bright(const float* light, const BrightPassSettings& settings) {
    Color color = repaired(light);
    const double m = settings.measure == BrightMeasure::luminance
                         ? 0.2125 * color[0] + 0.7154 * color[1] + 0.0721 * color[2]
                         : *std::max_element(color.begin(), color.end());
    const double share = bright_share(m, settings.threshold, settings.knee);
    for (double& value : color) value *= share;
    return color;
}

void weigh_blocks(ImageD& light) {
    for (int top = 0; top < light.height(); top += firefly_block_px) {
        for (int left = 0; left < light.width(); left += firefly_block_px) {
            const Region block = Region{left, top, firefly_block_px, firefly_block_px}.intersected(light.bounds());
            // Pixels outside of the frame are dark and weigh 1.
            const int all = firefly_block_px * firefly_block_px;
            double weights = all - block.width * block.height;
            for (int pass = 0; pass < 2; ++pass) {
                for (int y = block.y; y < block.y + block.height; ++y) {
                    for (int x = block.x; x < block.x + block.width; ++x) {
                        double* p = light.pixel(x, y);
                        const double size = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
                        const double weight = 1 / (1 + size / firefly_limit_plate_linear);
                        if (pass == 0) {
                            weights += weight;
                        } else {
                            for (int c = 0; c < 3; ++c) p[c] *= weight * all / weights;
                        }
                    }
                }
            }
        }
    }
}

}  // namespace

ImageD reference_bright_light(const ImageF& after, const ImageF& before, const BrightPassSettings& settings) {
    ImageD light(after.width(), after.height(), 3);
    const bool takes_away = !before.empty() && settings.share != BrightShare::objects;
    for (int y = 0; y < after.height(); ++y) {
        for (int x = 0; x < after.width(); ++x) {
            const float* with_objects = after.pixel(x, y);
            const double a = with_objects[3] > 0 ? std::min<double>(with_objects[3], 1) : 0;
            const double counts = settings.share == BrightShare::all    ? 1 + a * (settings.object_strength - 1)
                                  : settings.share == BrightShare::rest ? 1 - a
                                                                        : a * settings.object_strength;
            const Color added = bright(with_objects, settings);
            const Color taken = takes_away ? bright(before.pixel(x, y), settings) : Color{};
            for (std::size_t c = 0; c < 3; ++c) {
                light.at(x, y, static_cast<int>(c)) = added[c] * counts - taken[c];
            }
        }
    }
    if (settings.firefly_safe) weigh_blocks(light);
    return light;
}

double energy_held_back(const ImageF& after, const ImageF& before, BrightPassSettings settings) {
    settings.firefly_safe = false;
    const ImageD all = reference_bright_light(after, before, settings);
    settings.firefly_safe = true;
    const ImageD kept = reference_bright_light(after, before, settings);
    double sum = 0;
    for (std::size_t i = 0; i < all.samples().size(); ++i) {
        sum += std::abs(all.samples()[i]) - std::abs(kept.samples()[i]);
    }
    return sum;
}

}  // namespace matchlight
