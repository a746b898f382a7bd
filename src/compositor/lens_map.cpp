// Inverts the distortion once a clip, on a grid.
#include "compositor/lens_map.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace matchlight {

LensMap make_lens_map(const Camera& camera) {
    constexpr int spacing = LensMap::spacing;
    // One node before the first pixel and at least one behind the last, so that every pixel lies inside a cell.
    const int columns = (camera.width + spacing - 1) / spacing + 2;
    const int rows = (camera.height + spacing - 1) / spacing + 2;
    LensMap map{ImageF(columns, rows, 2), {}};
    parallel_for(rows, [&](int row) {
        for (int column = 0; column < columns; ++column) {
            const Eigen::Vector2d pixel((column - 1) * spacing, (row - 1) * spacing);
            const Eigen::Vector2d normalized = camera.normalized_from_pixel(pixel);
            map.nodes.at(column, row, 0) = static_cast<float>(normalized.x());
            map.nodes.at(column, row, 1) = static_cast<float>(normalized.y());
        }
    });
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const Eigen::Vector2d node(map.nodes.at(column, row, 0), map.nodes.at(column, row, 1));
            if (node.allFinite()) map.normalized_bounds.extend(node);
        }
    }
    return map;
}

Eigen::Vector2d LensMap::normalized(double x, double y) const {
    const double u = x / spacing + 1;
    const double v = y / spacing + 1;
    const int column = static_cast<int>(std::clamp(std::floor(u), 0.0, nodes.width() - 2.0));
    const int row = static_cast<int>(std::clamp(std::floor(v), 0.0, nodes.height() - 2.0));
    const double s = u - column;
    const double t = v - row;
    const auto node = [&](int i, int j) {
        return Eigen::Vector2d(nodes.at(column + i, row + j, 0), nodes.at(column + i, row + j, 1));
    };
    return (1 - t) * ((1 - s) * node(0, 0) + s * node(1, 0)) + t * ((1 - s) * node(0, 1) + s * node(1, 1));
}

}  // namespace matchlight
