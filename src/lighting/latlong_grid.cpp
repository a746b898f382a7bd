// Closed forms of the integrals over lat-long pixels.
#include "lighting/latlong_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace matchlight {
namespace {

using std::numbers::pi;

LatlongRow row_between(double top, double bottom) {
    const double z0 = std::cos(top);
    const double z1 = std::cos(bottom);
    const double s0 = std::sin(top);
    const double s1 = std::sin(bottom);
    LatlongRow row;
    row.z_top = z0;
    row.z_bottom = z1;
    // cos a − cos b as a product: no cancellation at the poles, where rows are thin in z.
    row.sin1 = 2 * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2);
    row.sin1_cos1 = row.sin1 * (z0 + z1) / 2;
    row.sin1_cos2 = row.sin1 * (z0 * z0 + z0 * z1 + z1 * z1) / 3;
    row.sin2 = ((bottom - top) - (s1 * z1 - s0 * z0)) / 2;
    row.sin2_cos1 = (s1 * s1 * s1 - s0 * s0 * s0) / 3;
    row.sin3 = row.sin1 - row.sin1_cos2;
    return row;
}

}  // namespace

LatlongGrid::LatlongGrid(int width, int height) : azimuth_step_(2 * pi / width) {
    assert(width > 0 && height > 0);
    rows_.reserve(static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) rows_.push_back(row_between(pi * y / height, pi * (y + 1) / height));
    columns_.reserve(static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x) {
        const double left = azimuth_step_ * x - pi;
        const double right = azimuth_step_ * (x + 1) - pi;
        columns_.push_back({std::cos(left) - std::cos(right), std::sin(right) - std::sin(left),
                            (std::cos(2 * left) - std::cos(2 * right)) / 2,
                            (std::sin(2 * right) - std::sin(2 * left)) / 2});
    }
}

LatlongRow LatlongGrid::row_above(int y, double minimum_z) const {
    const double top = pi * y / height();
    const double bottom = pi * (y + 1) / height();
    const double limit = std::acos(std::clamp(minimum_z, -1.0, 1.0));
    // A sliver of a thousand-millionth of a row is rounding of the limit, not light.
    const double rounding = 1e-9 * (bottom - top);
    if (limit >= bottom - rounding) return row(y);
    if (limit <= top + rounding) return {};
    return row_between(top, limit);
}

}  // namespace matchlight
