// A summed-area table of marked cells (Crow 1984, "Summed-Area Tables for Texture Mapping"): any box in four look-ups.
#include <algorithm>
#include <array>
#include <cmath>

#include "render/effects/contact_shadow.h"

namespace matchlight {

namespace {

/// The texels of a map, RGB, and where they lie.
struct LossTexels {
    explicit LossTexels(const ShadowMap& map)
        : loss(map.loss.read<float>(map.loss.bounds(), 3)),
          first_m(map.rectangle_m.min()),
          size_m(map.rectangle_m.sizes().array() / Eigen::Array2d(loss.width(), loss.height())) {}

    /// From texel to texel, all of both.
    Eigen::AlignedBox2d box_m(int left, int top, int right, int bottom) const {
        return {first_m + (size_m * Eigen::Array2d(left, top)).matrix(),
                first_m + (size_m * Eigen::Array2d(right + 1, bottom + 1)).matrix()};
    }

    ImageF loss;
    Eigen::Vector2d first_m;
    Eigen::Array2d size_m;  // of a texel
};

void mark_loss(SurfaceCells& cells, const ShadowMap& map, double least_loss) {
    const LossTexels texels(map);
    for (int y = 0; y < texels.loss.height(); ++y) {
        for (int x = 0; x < texels.loss.width(); ++x) {
            const float* p = texels.loss.pixel(x, y);
            // Bilinear look-ups carry a texel's loss one texel further, on all sides.
            if (std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) > least_loss)
                cells.mark(texels.box_m(x - 1, y - 1, x + 1, y + 1));
        }
    }
}

/// By second differences over a cell's width.
void mark_bends(SurfaceCells& cells, const ShadowMap& map, double least_bend) {
    const LossTexels texels(map);
    const int width = texels.loss.width(), height = texels.loss.height();
    const Eigen::Array2i lag =
        (cells.cell_m().minCoeff() / texels.size_m).ceil().max(1.0).min(std::max(width, height)).cast<int>();
    static constexpr std::array<float, 3> nothing{};
    const auto at = [&](int x, int y) {
        return x < 0 || y < 0 || x >= width || y >= height ? nothing.data() : texels.loss.pixel(x, y);
    };
    const auto bends = [&](int x, int y, int dx, int dy) {
        const float *before = at(x - dx, y - dy), *here = at(x, y), *after = at(x + dx, y + dy);
        for (int c = 0; c < 3; ++c) {
            if (std::abs(before[c] - 2 * here[c] + after[c]) > least_bend) return true;
        }
        return false;
    };
    // Beyond the rim, too, where the loss ends.
    for (int y = -lag.y(); y < height + lag.y(); ++y) {
        for (int x = -lag.x(); x < width + lag.x(); ++x) {
            if (bends(x, y, lag.x(), 0) || bends(x, y, 0, lag.y()))
                cells.mark(texels.box_m(x - lag.x(), y - lag.y(), x + lag.x(), y + lag.y()));
        }
    }
}

}  // namespace

SurfaceCells::SurfaceCells(const Eigen::AlignedBox2d& rectangle_m)
    : rectangle_m_(rectangle_m), sums_(static_cast<std::size_t>(cells + 1) * (cells + 1), 0) {}

Eigen::Array2i SurfaceCells::cell_of(const Eigen::Vector2d& point_m) const {
    const Eigen::Array2d share = (point_m - rectangle_m_.min()).array() / rectangle_m_.sizes().array();
    // Clamped before the conversion: a far-off point need not fit an int.
    return (share * cells).max(0.0).min(cells - 1.0).cast<int>();
}

void SurfaceCells::mark(const Eigen::AlignedBox2d& box_m) {
    const Eigen::Array2i low = cell_of(box_m.min()), high = cell_of(box_m.max());
    for (int v = low.y(); v <= high.y(); ++v) {
        std::fill_n(sums_.begin() + static_cast<std::ptrdiff_t>(v + 1) * (cells + 1) + low.x() + 1,
                    high.x() - low.x() + 1, 1);
    }
}

void SurfaceCells::sum_up() {
    for (int y = 1; y <= cells; ++y) {
        std::int32_t row = 0;
        for (int x = 1; x <= cells; ++x) {
            std::int32_t& sum = sums_[static_cast<std::size_t>(y) * (cells + 1) + x];
            row += sum;
            sum = row + sums_[static_cast<std::size_t>(y - 1) * (cells + 1) + x];
        }
    }
}

bool SurfaceCells::any_in(const Eigen::AlignedBox2d& box_m) const {
    if (!rectangle_m_.intersects(box_m)) return false;
    const Eigen::Array2i low = cell_of(box_m.min());
    const Eigen::Array2i high = cell_of(box_m.max()) + 1;
    const auto sum = [&](int x, int y) { return sums_[static_cast<std::size_t>(y) * (cells + 1) + x]; };
    return sum(high.x(), high.y()) - sum(low.x(), high.y()) - sum(high.x(), low.y()) + sum(low.x(), low.y()) > 0;
}

ShadowFootprint::ShadowFootprint(const ShadowMap& far, const ShadowMap& fine, double least_loss)
    : cells_(far.rectangle_m.merged(fine.rectangle_m)) {
    // Either map may stay below the limit where their sum does not: each is held to half of it.
    mark_loss(cells_, far, least_loss / 2);
    mark_loss(cells_, fine, least_loss / 2);
    cells_.sum_up();
}

ShadowDetail::ShadowDetail(const ShadowMap& far, const ShadowMap& fine, double least_bend)
    : cells_(far.rectangle_m.merged(fine.rectangle_m)) {
    mark_bends(cells_, far, least_bend / 2);
    mark_bends(cells_, fine, least_bend / 2);
    cells_.sum_up();
}

}  // namespace matchlight
