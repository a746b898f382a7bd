// The table behind LensGrid.
#include "tracking/lens_grid.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace matchlight {

namespace {

Eigen::Vector2d pinhole_normalized(const Camera& camera, double x, double y) {
    return {(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy};
}

}  // namespace

LensGrid::LensGrid(const Camera& camera)
    : camera_(camera),
      pinhole_(camera.lens == LensModel::radtan && !camera.has_distortion()),
      // The lens bends by its width's measure: a finer grid for smaller frames keeps the error in pixels.
      step_px_(std::max(2, camera.width / 480)) {
    if (pinhole_) return;
    columns_ = camera.width / step_px_ + 2;
    rows_ = camera.height / step_px_ + 2;
    correction_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    parallel_for(rows_, [&](int row) {
        for (int column = 0; column < columns_; ++column) {
            const double x = column * step_px_;
            const double y = row * step_px_;
            correction_[static_cast<std::size_t>(row) * columns_ + column] =
                camera_.normalized_from_pixel({x, y}) - pinhole_normalized(camera_, x, y);
        }
    });
}

Eigen::Vector2d LensGrid::normalized_from_pixel(double x, double y) const {
    const Eigen::Vector2d straight = pinhole_normalized(camera_, x, y);
    if (pinhole_) return straight;
    const int column = std::clamp(static_cast<int>(std::floor(x / step_px_)), 0, columns_ - 2);
    const int row = std::clamp(static_cast<int>(std::floor(y / step_px_)), 0, rows_ - 2);
    const double fx = x / step_px_ - column;
    const double fy = y / step_px_ - row;
    const Eigen::Vector2d* cell = &correction_[static_cast<std::size_t>(row) * columns_ + column];
    const Eigen::Vector2d top = cell[0] + fx * (cell[1] - cell[0]);
    const Eigen::Vector2d bottom = cell[columns_] + fx * (cell[columns_ + 1] - cell[columns_]);
    return straight + top + fy * (bottom - top);
}

}  // namespace matchlight
