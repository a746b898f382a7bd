// An even grid over the picture.
#include "render/sphere_cover.h"

#include <algorithm>
#include <cmath>

namespace matchlight {
namespace {

/// Tiles along a side of the picture: cells that are worth a question are wider than one, or are many.
constexpr int side = 64;
/// A seventh of what so many discs fall on by chance is bare.
constexpr double least_hiding_depth = 2;

}  // namespace

SphereCover::SphereCover(int width_px, int height_px)
    : tile_px_(std::max(width_px, 1) / double(side), std::max(height_px, 1) / double(side)),
      depths_(static_cast<std::size_t>(side) * side, 0.0) {}

template <class Each>
void SphereCover::for_tiles(const Eigen::AlignedBox2d& box_px, const Each& each) const {
    if (box_px.isEmpty()) return;
    const auto tile = [&](const Eigen::Vector2d& at) -> Eigen::Array2i {
        return (at.array() / tile_px_).floor().max(0).min(side - 1).cast<int>();
    };
    const Eigen::Array2i first = tile(box_px.min()), last = tile(box_px.max());
    for (int y = first.y(); y <= last.y(); ++y) {
        for (int x = first.x(); x <= last.x(); ++x) {
            if (!each(static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x))) return;
        }
    }
}

void SphereCover::add(const CellInPicture& cell) {
    double tiles = 0;
    for_tiles(cell.box_px, [&](std::size_t) {
        tiles += 1;
        return true;
    });
    if (tiles == 0) return;
    const double depth = cell.discs_px / (tiles * tile_px_.prod());
    for_tiles(cell.box_px, [&](std::size_t tile) {
        depths_[tile] += depth;
        return true;
    });
}

bool SphereCover::may_hide(const CellInPicture& cell) const {
    // By chance none of its pixels is bare.
    const double hiding_depth = std::max(least_hiding_depth, std::log(std::max(cell.box_px.volume(), 1.0)));
    bool hides = true;
    for_tiles(cell.box_px, [&](std::size_t tile) {
        hides = depths_[tile] >= hiding_depth;
        return hides;
    });
    return hides;
}

}  // namespace matchlight
