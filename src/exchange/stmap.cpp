// Both maps go through the exact lens, pixel by pixel.
#include "exchange/stmap.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "core/parallel.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

Vector2d pixel_of(const PinholePicture& picture, const Vector2d& normalized) {
    return {picture.fx * normalized.x() + picture.cx, picture.fy * normalized.y() + picture.cy};
}

/// `source_px` gives the pixel of the source for each pixel, NaN where there is none.
Stmap map_of(int width, int height, int source_width, int source_height,
             const std::function<Vector2d(const Vector2d&)>& source_px) {
    Stmap stmap{ImageF(width, height, 3), 0};
    std::vector<std::int64_t> unreachable(static_cast<std::size_t>(height), 0);
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            const Vector2d source = source_px(Vector2d(x, y));
            float* texel = stmap.map.pixel(x, y);
            if (source.allFinite()) {
                texel[0] = static_cast<float>((source.x() + 0.5) / source_width);
                texel[1] = static_cast<float>(1 - (source.y() + 0.5) / source_height);
                texel[2] = 1;
            } else {
                texel[0] = texel[1] = -1;
                texel[2] = 0;
                ++unreachable[static_cast<std::size_t>(y)];
            }
        }
    });
    stmap.unreachable = std::accumulate(unreachable.begin(), unreachable.end(), std::int64_t{0});
    return stmap;
}

bool inside(const PinholePicture& picture, const Vector2d& px) {
    return px.x() >= -0.5 && px.y() >= -0.5 && px.x() <= picture.width - 0.5 && px.y() <= picture.height - 0.5;
}

/// What the plate needs of the undistorted picture.
struct PlateOutline {
    double overscan = 1;      // how many times as wide and high it must be about its middle to hold all that is reached
    bool all_reached = true;  // by the lens model, all around
};

PlateOutline outline_of(const Camera& camera, const PinholePicture& frame) {
    // The outline of an unfolded map is the image of the plate's outline; a lattice inside serves lenses that do
    // not reach the outline.
    constexpr int lattice_px = 8;
    std::vector<PlateOutline> rows(static_cast<std::size_t>(camera.height) + 1);
    parallel_for(camera.height + 1, [&](int row) {
        const bool border = row == 0 || row == camera.height;
        // Other rows: their ends, which belong to the outline.
        const int step = border ? 1 : row % lattice_px == 0 ? lattice_px : camera.width;
        PlateOutline& found = rows[static_cast<std::size_t>(row)];
        for (int column = 0; column <= camera.width; column += std::min(step, std::max(1, camera.width - column))) {
            const Vector2d normalized = camera.normalized_from_pixel({column - 0.5, row - 0.5});
            if (!normalized.allFinite()) {
                found.all_reached = false;
                continue;
            }
            const Vector2d px = pixel_of(frame, normalized);
            found.overscan = std::max({found.overscan, std::abs(px.x() - (frame.width - 1) / 2.0) / (frame.width / 2.0),
                                       std::abs(px.y() - (frame.height - 1) / 2.0) / (frame.height / 2.0)});
        }
    });
    PlateOutline outline;
    for (const PlateOutline& row : rows) {
        outline.overscan = std::max(outline.overscan, row.overscan);
        outline.all_reached = outline.all_reached && row.all_reached;
    }
    return outline;
}

std::int64_t uncovered_pixels(const Camera& camera, const PinholePicture& picture) {
    std::vector<std::int64_t> uncovered(static_cast<std::size_t>(camera.height), 0);
    parallel_for(camera.height, [&](int y) {
        for (int x = 0; x < camera.width; ++x) {
            const Vector2d normalized = camera.normalized_from_pixel(Vector2d(x, y));
            const bool covered = normalized.allFinite() && inside(picture, pixel_of(picture, normalized));
            uncovered[static_cast<std::size_t>(y)] += covered ? 0 : 1;
        }
    });
    return std::accumulate(uncovered.begin(), uncovered.end(), std::int64_t{0});
}

}  // namespace

UndistortedPicture undistorted_picture(const Camera& camera, std::optional<double> overscan, bool centred) {
    UndistortedPicture picture;
    const PinholePicture frame = pinhole_of(camera, centred);
    const PlateOutline outline = outline_of(camera, frame);
    const double factor = std::clamp(overscan.value_or(outline.overscan), 1.0, largest_overscan);
    // A thousandth of a pixel of rounding must not cost a column.
    constexpr double rounding_px = 1e-3;
    picture.margin_x = static_cast<int>(std::ceil((factor - 1) * camera.width / 2 - rounding_px));
    picture.margin_y = static_cast<int>(std::ceil((factor - 1) * camera.height / 2 - rounding_px));
    picture.pinhole = frame;
    picture.pinhole.width += 2 * picture.margin_x;
    picture.pinhole.height += 2 * picture.margin_y;
    picture.pinhole.cx += picture.margin_x;
    picture.pinhole.cy += picture.margin_y;
    picture.overscan = static_cast<double>(picture.pinhole.width) / camera.width;
    // What lies inside the outline is covered where the outline is.
    if (!outline.all_reached || outline.overscan > factor) {
        picture.uncovered = uncovered_pixels(camera, picture.pinhole);
    }
    return picture;
}

Stmap undistort_map(const Camera& camera, const UndistortedPicture& picture) {
    const PinholePicture& p = picture.pinhole;
    return map_of(p.width, p.height, camera.width, camera.height, [&](const Vector2d& px) -> Vector2d {
        const Vector2d normalized((px.x() - p.cx) / p.fx, (px.y() - p.cy) / p.fy);
        const Vector2d plate = camera.pixel_from_normalized(normalized);
        if (!camera.has_distortion() || !plate.allFinite()) return plate;
        // A lens polynomial that folds back sends directions far outside into the plate: only those count that the
        // plate's own pixel leads back to.
        constexpr double same_px = 1e-3;
        const Vector2d back = camera.normalized_from_pixel(plate);
        const bool unfolded = back.allFinite() && (pixel_of(p, back) - px).norm() < same_px;
        return unfolded ? plate : Vector2d::Constant(std::nan(""));
    });
}

Stmap redistort_map(const Camera& camera, const UndistortedPicture& picture) {
    const PinholePicture& p = picture.pinhole;
    return map_of(camera.width, camera.height, p.width, p.height,
                  [&](const Vector2d& px) { return pixel_of(p, camera.normalized_from_pixel(px)); });
}

}  // namespace matchlight
