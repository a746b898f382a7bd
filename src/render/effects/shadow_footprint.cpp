// A summed-area table of marked cells (Crow 1984, "Summed-Area Tables for Texture Mapping"): any box in four look-ups.
#include <algorithm>

#include "render/effects/contact_shadow.h"

namespace matchlight {

ShadowFootprint::ShadowFootprint(const ShadowMap& far, const ShadowMap& fine, double least_loss)
    : rectangle_m_(far.rectangle_m.merged(fine.rectangle_m)),
      sums_(static_cast<std::size_t>(cells + 1) * (cells + 1), 0) {
    // Either map may stay below the limit where their sum does not: each is held to half of it.
    mark(far, least_loss / 2);
    mark(fine, least_loss / 2);
    for (int y = 1; y <= cells; ++y) {
        std::int32_t row = 0;
        for (int x = 1; x <= cells; ++x) {
            std::int32_t& sum = sums_[static_cast<std::size_t>(y) * (cells + 1) + x];
            row += sum != 0 ? 1 : 0;
            sum = row + sums_[static_cast<std::size_t>(y - 1) * (cells + 1) + x];
        }
    }
}

Eigen::Array2i ShadowFootprint::cell_of(const Eigen::Vector2d& point_m) const {
    const Eigen::Array2d share = (point_m - rectangle_m_.min()).array() / rectangle_m_.sizes().array();
    // Clamped before the conversion: a far-off point need not fit an int.
    return (share * cells).max(0.0).min(cells - 1.0).cast<int>();
}

void ShadowFootprint::mark(const ShadowMap& map, double least_loss) {
    const ImageF loss = map.loss.read<float>(map.loss.bounds(), 3);
    const Eigen::Array2d texel_m = map.rectangle_m.sizes().array() / Eigen::Array2d(loss.width(), loss.height());
    for (int y = 0; y < loss.height(); ++y) {
        for (int x = 0; x < loss.width(); ++x) {
            const float* p = loss.pixel(x, y);
            if (!(std::max({p[0], p[1], p[2]}) > least_loss)) continue;
            // Bilinear look-ups carry a texel's loss one texel further, on all sides.
            const Eigen::Array2i low =
                cell_of(map.rectangle_m.min() + (texel_m * Eigen::Array2d(x - 1, y - 1)).matrix());
            const Eigen::Array2i high =
                cell_of(map.rectangle_m.min() + (texel_m * Eigen::Array2d(x + 2, y + 2)).matrix());
            for (int v = low.y(); v <= high.y(); ++v) {
                for (int u = low.x(); u <= high.x(); ++u) {
                    sums_[static_cast<std::size_t>(v + 1) * (cells + 1) + u + 1] = 1;
                }
            }
        }
    }
}

bool ShadowFootprint::touches(const Eigen::AlignedBox2d& box_m) const {
    if (!rectangle_m_.intersects(box_m)) return false;
    const Eigen::Array2i low = cell_of(box_m.min());
    const Eigen::Array2i high = cell_of(box_m.max()) + 1;
    const auto sum = [&](int x, int y) { return sums_[static_cast<std::size_t>(y) * (cells + 1) + x]; };
    return sum(high.x(), high.y()) - sum(low.x(), high.y()) - sum(high.x(), low.y()) + sum(low.x(), low.y()) > 0;
}

}  // namespace matchlight
