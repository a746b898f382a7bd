// Box and Gaussian convolved with the steps of a tag's cells.
#include "tracking/blurred_pattern.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace matchlight {

namespace {

constexpr int most_cells = 16;

/// Φ and φ by second-order Taylor steps from a table: within 1e-8 of erfc and exp, at a tenth of their cost, which is
/// most of the fit's.
struct NormalDistribution {
    static constexpr double end = 6;  // beyond: 1e-9
    static constexpr int steps_per_unit = 256;

    struct Value {
        double distribution = 0, density = 0;
    };

    NormalDistribution() {
        for (std::size_t i = 0; i < table_.size(); ++i) {
            const double z = static_cast<double>(i) / steps_per_unit - end;
            table_[i] = {0.5 * std::erfc(-z / std::numbers::sqrt2),
                         std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2};
        }
    }

    Value at(double z) const {
        if (z <= -end) return {0, 0};
        if (z >= end) return {1, 0};
        constexpr double half_a_step = 0.5 / steps_per_unit;
        const auto index = static_cast<std::size_t>((z + end + half_a_step) * steps_per_unit);
        const double from = static_cast<double>(index) / steps_per_unit - end;
        const double step = z - from;
        const Value& value = table_[index];
        return {value.distribution + value.density * step * (1 - 0.5 * from * step),
                value.density * (1 - step * (from - 0.5 * step * (from * from - 1)))};
    }

private:
    std::array<Value, 2 * static_cast<std::size_t>(end) * steps_per_unit + 2> table_;
};

const NormalDistribution& normal_distribution() {
    static const NormalDistribution table;
    return table;
}

/// Share of the footprint beyond a grid line, and its derivatives by the footprint's place and by the blur.
struct Step {
    double share = 1, by_place = 0, by_blur = 0;
};

/// ∫ box ⊗ Gaussian of a unit step at 0, for a footprint centred at `distance`. With ψ(z) = zΦ(z) + φ(z), ψ' = Φ.
Step step_at(double distance, const AxisFootprint& footprint) {
    const double high = (distance + footprint.pixel_width / 2) / footprint.blur;
    const double low = (distance - footprint.pixel_width / 2) / footprint.blur;
    const NormalDistribution::Value at_high = normal_distribution().at(high), at_low = normal_distribution().at(low);
    Step step;
    step.share = ((high * at_high.distribution + at_high.density) - (low * at_low.distribution + at_low.density)) *
                 footprint.blur / footprint.pixel_width;
    step.by_place = (at_high.distribution - at_low.distribution) / footprint.pixel_width;
    step.by_blur = (at_high.density - at_low.density) / footprint.pixel_width;
    return step;
}

/// The cells a footprint touches along one axis, with their shares.
struct AxisShares {
    int first = 0;
    int count = 0;
    std::array<Step, most_cells> cell;
};

AxisShares shares_along(double place, int cells, const AxisFootprint& footprint) {
    constexpr double sigmas = 4;  // beyond: 3e-5 of a step
    const double reach = sigmas * footprint.blur + footprint.pixel_width / 2;
    const int first_line = std::max(1, static_cast<int>(std::ceil(std::max(place - reach, 0.0))));
    const int last_line = std::min(cells - 1, static_cast<int>(std::floor(std::min(place + reach, double(cells)))));
    AxisShares shares;
    if (last_line < first_line) {
        shares.first = std::clamp(static_cast<int>(std::floor(place)), 0, cells - 1);
        shares.count = 1;
        return shares;
    }
    shares.first = first_line - 1;
    Step before;  // everything lies beyond the first line's left neighbour
    for (int line = first_line; line <= last_line; ++line) {
        const Step after = step_at(place - line, footprint);
        shares.cell[static_cast<std::size_t>(shares.count++)] = {
            before.share - after.share, before.by_place - after.by_place, before.by_blur - after.by_blur};
        before = after;
    }
    shares.cell[static_cast<std::size_t>(shares.count++)] = before;
    return shares;
}

}  // namespace

BlurredPattern::BlurredPattern(const TagPattern& pattern) : cells_(pattern.cells) {
    assert(cells_ <= most_cells);
    const auto count = static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
    ink_.resize(count);
    for (int y = 0; y < cells_; ++y) {
        for (int x = 0; x < cells_; ++x) {
            int nearest = std::numeric_limits<int>::max();
            for (int v = 0; v < cells_; ++v) {
                for (int u = 0; u < cells_; ++u) {
                    const int distance = (u - x) * (u - x) + (v - y) * (v - y);
                    if (pattern.at(u, v) == TagPattern::unknown || distance >= nearest) continue;
                    nearest = distance;
                    ink_[static_cast<std::size_t>(y) * cells_ + x] = pattern.at(u, v);
                }
            }
        }
    }
    const auto told = [&](int half_x, int half_y) {
        if (half_x < 0 || half_y < 0 || half_x >= 2 * cells_ || half_y >= 2 * cells_) return false;
        return pattern.at(half_x / 2, half_y / 2) != TagPattern::unknown;
    };
    known_halves_.resize(4 * count);
    for (int y = 0; y < 2 * cells_; ++y) {
        for (int x = 0; x < 2 * cells_; ++x) {
            bool known = true;
            for (int v = -1; v <= 1; ++v) {
                for (int u = -1; u <= 1; ++u) known = known && told(x + u, y + v);
            }
            known_halves_[static_cast<std::size_t>(y) * 2 * cells_ + x] = known;
        }
    }
}

PatternSample BlurredPattern::at(double a, double b, const AxisFootprint& along_a, const AxisFootprint& along_b,
                                 double covariance) const {
    const AxisShares columns = shares_along(a, cells_, along_a);
    const AxisShares rows = shares_along(b, cells_, along_b);
    PatternSample sample;
    for (int j = 0; j < rows.count; ++j) {
        double paper = 0, by_a = 0, by_blur_a = 0;
        for (int i = 0; i < columns.count; ++i) {
            const double ink = ink_at(columns.first + i, rows.first + j);
            const Step& column = columns.cell[static_cast<std::size_t>(i)];
            paper += ink * column.share;
            by_a += ink * column.by_place;
            by_blur_a += ink * column.by_blur;
        }
        const Step& row = rows.cell[static_cast<std::size_t>(j)];
        sample.paper += row.share * paper;
        sample.by_a += row.share * by_a;
        sample.by_blur_a += row.share * by_blur_a;
        sample.by_b += row.by_place * paper;
        sample.by_blur_b += row.by_blur * paper;
        sample.by_covariance += row.by_place * by_a;
    }
    sample.paper += covariance * sample.by_covariance;
    return sample;
}

bool BlurredPattern::is_known(double a, double b) const {
    if (!(a >= 0 && b >= 0 && a < cells_ && b < cells_)) return false;
    return known_halves_[static_cast<std::size_t>(2 * b) * 2 * cells_ + static_cast<std::size_t>(2 * a)] != 0;
}

double BlurredPattern::distance_to_edge(double a, double b) const {
    const int x = std::clamp(static_cast<int>(a), 0, cells_ - 1);
    const int y = std::clamp(static_cast<int>(b), 0, cells_ - 1);
    const double here = ink_at(x, y);
    double distance = 1;
    for (int v = std::max(0, y - 1); v <= std::min(cells_ - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(cells_ - 1, x + 1); ++u) {
            if (ink_at(u, v) == here) continue;
            const double du = u < x ? a - x : (u > x ? x + 1 - a : 0);
            const double dv = v < y ? b - y : (v > y ? y + 1 - b : 0);
            distance = std::min(distance, std::max(du, dv));
        }
    }
    return distance;
}

}  // namespace matchlight
