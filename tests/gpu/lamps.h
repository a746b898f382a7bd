// A frame with lamps of several sizes and colours: one at the edge, one hidden, on a grey ground.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "effect_frame.h"

namespace matchlight::test {

inline LightOnCpu lamps(int width, int height) {
    LightOnCpu light(width, height);
    light.before = ImageF(width, height, 3, 0.2F);
    const auto disc = [&](double cx, double cy, double radius, std::array<float, 3> color, bool is_before) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                if (std::hypot(x - cx * width, y - cy * height) > radius * height) continue;
                for (int c = 0; c < 3; ++c) {
                    (is_before ? light.before : light.after).at(x, y, c) = color[static_cast<std::size_t>(c)];
                }
            }
        }
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) light.set(x, y, 0.2F, 1);
    }
    disc(0.3, 0.4, 0.05, {8, 6, 3}, false);
    disc(0.7, 0.25, 0.012, {200, 220, 260}, false);
    disc(0.62, 0.8, 0.002, {300, 30, 20}, false);
    disc(1.0, 0.55, 0.03, {30, 30, 30}, false);
    disc(0.5, 0.62, 0.02, {10, 10, 10}, true);
    return light;
}

/// A lamp 8 pixels square that comes in over the frame's left edge; its own left edge is at `left`.
inline LightOnCpu entering_lamp(double left, double value) {
    LightOnCpu light(320, 180);
    for (int x = 0; x < 20; ++x) {
        const double covered = std::clamp(left + 8 - x, 0.0, 1.0) - std::clamp(left - x, 0.0, 1.0);
        for (int y = 80; y < 88; ++y) light.set(x, y, static_cast<float>(value * covered));
    }
    return light;
}

/// A square lamp of one pixel at `x`, `y`: its light is shared among the pixels it covers.
inline LightOnCpu small_sun(double x, double y, float value, int width, int height) {
    LightOnCpu light(width, height);
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            const int px = static_cast<int>(std::floor(x)) + i, py = static_cast<int>(std::floor(y)) + j;
            const double share = (1 - std::abs(x - px)) * (1 - std::abs(y - py));
            if (light.frame.contains(px, py)) light.set(px, py, static_cast<float>(value * share));
        }
    }
    return light;
}

}  // namespace matchlight::test
