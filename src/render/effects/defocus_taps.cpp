// Discs and rings of pixels.
#include "render/effects/defocus_taps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace matchlight {

void OnePassKnobs::check() const {
    const auto require = [](const char* name, int value, int least, int most) {
        if (value < least || value > most)
            throw std::invalid_argument(fmt::format("{} is {}, not from {} to {}", name, value, least, most));
    };
    require("rings", rings, 1, 4096);
    require("ring_samples", ring_samples, 3, 4096);
    require("largest_radius_px", largest_radius_px, 1, 16384);
}

std::vector<DefocusTap> disc_taps(double radius_px) {
    std::vector<DefocusTap> taps;
    const int reach = static_cast<int>(std::ceil(radius_px));
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            const double away = std::hypot(x, y);
            if (away < radius_px + 0.5) taps.push_back({x, y, static_cast<float>(away), 1});
        }
    }
    return taps;
}

std::vector<DefocusTap> ring_taps(double radius_px, const OnePassKnobs& knobs) {
    constexpr double pi = std::numbers::pi;
    // The pixel itself is a disc of area 1; the rest lies between it and the soft rim. Edges of rings go by the square
    // of their number: small circles need close ones.
    const double inner = 1 / std::sqrt(pi), outer = std::max(radius_px + 0.5, inner);
    const auto edge = [&](int ring) {
        const double t = static_cast<double>(ring) / knobs.rings;
        return inner + (outer - inner) * t * t;
    };
    std::map<std::pair<int, int>, double> areas{{{0, 0}, 1}};
    for (int ring = 0; ring < knobs.rings; ++ring) {
        const double from = edge(ring), to = edge(ring + 1), radius = (from + to) / 2;
        const double area = pi * (to * to - from * from) / knobs.ring_samples;
        for (int i = 0; i < knobs.ring_samples; ++i) {
            // Every other ring is turned by half a step.
            const double angle = 2 * pi * (i + 0.5 * (ring % 2)) / knobs.ring_samples;
            const auto at = [&](double value) { return static_cast<int>(std::lround(value)); };
            areas[{at(radius * std::sin(angle)), at(radius * std::cos(angle))}] += area;
        }
    }
    std::vector<DefocusTap> taps;
    taps.reserve(areas.size());
    for (const auto& [place, area] : areas) {
        const auto& [y, x] = place;
        taps.push_back({x, y, static_cast<float>(std::hypot(x, y)), static_cast<float>(area)});
    }
    return taps;
}

}  // namespace matchlight
