// Discs by bisection of their variance.
#include "render/effects/defocus_kernel.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "render/effects/bokeh.h"

namespace matchlight {

namespace {

double covered(const DiscTap& tap, double radius) {
    return std::clamp(radius + 0.5 - tap.distance, 0.0, 1.0);
}

double variance_of(const std::vector<DiscTap>& taps, double radius) {
    double sum = 0, moment = 0;
    for (const DiscTap& tap : taps) {
        const double share = covered(tap, radius);
        sum += share;
        moment += share * tap.offset.squaredNorm() / 2.0;
    }
    return moment / sum;
}

/// In texels of the coarse level: of the mean over 2^k texels and of linear interpolation between coarse ones.
double variance_of_resampling(int level) {
    if (level == 0) return 0;
    const double fine = std::exp2(-2.0 * level);  // a fine texel's area
    return (1 - fine) / 12 + (2 + fine) / 12;
}

}  // namespace

std::vector<DiscTap> disc_taps(const BokehSettings& bokeh, double radius, bool inverted) {
    std::vector<DiscTap> taps;
    // A rounded polygon's sides may come as near as cos(π/3) = ½ to the middle, its corners are at the radius.
    const int reach = static_cast<int>(std::ceil(radius + 0.5));
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            // A texel collects from the offset, so the disc's middle is there and the texel lies the other way.
            const double turn = inverted ? 1 : -1;
            const double distance = bokeh_distance(bokeh, turn * Eigen::Vector2d(x, y));
            if (distance <= radius + 0.5) taps.push_back({{x, y}, distance});
        }
    }
    std::ranges::stable_sort(taps, {}, &DiscTap::distance);
    return taps;
}

double bokeh_variance(const BokehSettings& bokeh) {
    // ∫∫ ½ ρ² ρ dρ dθ over the area: by fine steps of the angle, ρ to where the distance is 1.
    constexpr int steps = 4096;
    double moment = 0, area = 0;
    for (int i = 0; i < steps; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / steps;
        const double rim = 1 / bokeh_distance(bokeh, {std::cos(angle), std::sin(angle)});
        moment += std::pow(rim, 4) / 8;
        area += rim * rim / 2;
    }
    return moment / area;
}

DrawnDisc drawn_disc(const std::vector<DiscTap>& taps, double wanted_variance) {
    assert(!taps.empty());
    double low = 0, high = taps.back().distance + 0.5;
    if (wanted_variance > 0) {
        constexpr int halvings = 50;
        for (int i = 0; i < halvings; ++i) {
            const double middle = (low + high) / 2;
            (variance_of(taps, middle) < wanted_variance ? low : high) = middle;
        }
    } else {
        high = 0;
    }
    DrawnDisc disc{.radius = high, .texels = 0};
    for (const DiscTap& tap : taps) disc.texels += covered(tap, high);
    return disc;
}

ImageF disc_table(const BokehSettings& bokeh, double largest_radius, double step, int rows) {
    const int entries = static_cast<int>(std::ceil(largest_radius / step)) + 2;
    const std::vector<DiscTap> taps = disc_taps(bokeh, entries * step + 1, false);
    const double unit_variance = bokeh_variance(bokeh);
    ImageF table(entries, rows, 2);
    for (int row = 0; row < rows; ++row) {
        for (int i = 0; i < entries; ++i) {
            const double radius = i * step;
            const DrawnDisc disc = drawn_disc(taps, radius * radius * unit_variance - variance_of_resampling(row));
            table.at(i, row, 0) = static_cast<float>(disc.radius);
            table.at(i, row, 1) = static_cast<float>(disc.texels);
        }
    }
    return table;
}

}  // namespace matchlight
