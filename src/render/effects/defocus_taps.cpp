// Discs and rings of pixels.
#include "render/effects/defocus_taps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "render/effects/bokeh.h"

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

std::vector<DefocusTap> bokeh_taps(const BokehSettings& bokeh, double radius, bool before_focus) {
    constexpr int parts = 8;  // of a texel's side: its area to 1/64
    const int reach = static_cast<int>(std::ceil(radius + 0.5));
    const double turn = before_focus ? 1 : -1;
    std::vector<DefocusTap> taps;
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            int inside = 0;
            for (int v = 0; v < parts; ++v) {
                for (int u = 0; u < parts; ++u) {
                    const Eigen::Vector2d point(x + (u + 0.5) / parts - 0.5, y + (v + 0.5) / parts - 0.5);
                    if (bokeh_distance(bokeh, turn * point) <= radius) ++inside;
                }
            }
            const float area = static_cast<float>(inside) / (parts * parts);
            if (inside > 0) taps.push_back({x, y, static_cast<float>(std::hypot(x, y)), area});
        }
    }
    if (taps.empty()) taps.push_back({});  // finer than the parts
    return taps;
}

std::vector<DefocusSlice> defocus_slices(double nearest_px, double farthest_px, int count) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double before_px = std::max(0.0, -least_coc_px - nearest_px);
    const double behind_px = std::max(0.0, farthest_px - least_coc_px);
    std::vector<DefocusSlice> slices;
    // From `from_px` to `to_px` in about as many parts as it has of the whole.
    const auto add = [&](double from_px, double to_px) {
        const double share = (to_px - from_px) / (before_px + behind_px);
        const int parts = std::max(1, static_cast<int>(std::lround(count * share)));
        const double step_px = (to_px - from_px) / parts;
        for (int i = 0; i < parts; ++i)
            slices.push_back({from_px + i * step_px, from_px + (i + 1) * step_px, from_px + (i + 0.5) * step_px});
    };
    if (before_px > 0) add(nearest_px, -least_coc_px);
    slices.push_back({-least_coc_px, least_coc_px, 0});
    if (behind_px > 0) add(least_coc_px, farthest_px);
    // Ends meet exactly, and the outermost hold what rounding puts beyond them.
    for (std::size_t i = 1; i < slices.size(); ++i) slices[i].from_px = slices[i - 1].to_px;
    slices.front().from_px = -infinity;
    slices.back().to_px = infinity;
    std::reverse(slices.begin(), slices.end());
    return slices;
}

double circle_of_level_px(int level) {
    return level == 0 ? 0 : 2 * std::sqrt(2 * std::exp2(2 * level) - 1);
}

double full_circle_of_level_px(int level) {
    // The finest level is used from 0 on: half of its circle, as the levels' circles double.
    return level == 1 ? circle_of_level_px(1) / 2 : circle_of_level_px(level - 1);
}

}  // namespace matchlight
