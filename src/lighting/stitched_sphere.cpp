// Lattices of points in each pixel of the map, finer than the pictures' own pixels, so that lamps keep their energy.
#include "lighting/stitched_sphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "lighting/probe.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

/// The nine pixels around a point and what each counts: quadratic B-splines. They sum to 1 everywhere, and so smoothly
/// that two points to a pixel tell a lamp of one pixel its energy to half a per cent, where straight lines between
/// pixels would miss several.
using Taps = std::array<PixelTap, 9>;

std::array<double, 3> spline_weights(double offset) {
    return {0.5 * (0.5 - offset) * (0.5 - offset), 0.75 - offset * offset, 0.5 * (0.5 + offset) * (0.5 + offset)};
}

Taps taps_at(const SphereView& view, const Eigen::Vector2d& px) {
    const double middle_x = std::floor(px.x() + 0.5), middle_y = std::floor(px.y() + 0.5);
    const std::array<double, 3> across = spline_weights(px.x() - middle_x), down = spline_weights(px.y() - middle_y);
    const int width = view.light->width(), height = view.light->height();
    Taps taps;
    for (int i = 0; i < 9; ++i) {
        const int x = static_cast<int>(middle_x) + i % 3 - 1, y = static_cast<int>(middle_y) + i / 3 - 1;
        taps[static_cast<std::size_t>(i)] = {
            view.wraps ? (x % width + width) % width : std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1),
            across[static_cast<std::size_t>(i % 3)] * down[static_cast<std::size_t>(i / 3)]};
    }
    return taps;
}

bool all_black(const SphereView& view, const Taps& taps) {
    return std::ranges::all_of(taps, [&](const PixelTap& tap) {
        const float* p = view.light->pixel(tap.x, tap.y);
        return p[0] == 0 && p[1] == 0 && p[2] == 0;
    });
}

Eigen::Vector3d mean_of(const SphereView& view, const Taps& taps) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const PixelTap& tap : taps) {
        const float* p = view.light->pixel(tap.x, tap.y);
        sum += tap.weight * Eigen::Vector3d(p[0], p[1], p[2]);
    }
    return sum;
}

/// Points along a side of a pixel, two to a pixel of the finest picture; more than 32 serve nobody.
int points_a_side(std::span<const SphereView> views, int height) {
    double finest = 0;
    for (const SphereView& view : views) finest = std::max(finest, view.px_per_radian);
    return std::clamp(static_cast<int>(std::ceil(2 * finest * std::numbers::pi / height)), 2, 32);
}

/// Light and weight of all views together in a direction.
struct Blend {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    double clipped = 0;
    double weight = 0;
};

Blend blend_at(std::span<const SphereView> views, const Eigen::Vector3d& direction) {
    Blend blend;
    for (const SphereView& view : views) {
        const ViewPoint point = view.look(view.view_from_world * direction);
        if (point.weight <= 0) continue;
        const Taps taps = taps_at(view, point.px);
        if (view.black_is_unseen && all_black(view, taps)) continue;
        blend.light += point.weight * view.gain.cwiseProduct(mean_of(view, taps));
        blend.weight += point.weight;
        if (view.clipped == nullptr) continue;
        for (const PixelTap& tap : taps) blend.clipped += point.weight * tap.weight * view.clipped->at(tap.x, tap.y);
    }
    return blend;
}

}  // namespace

ImageF resampled(const StitchedSphere& sphere, const ProbeLayout& from, const ProbeLayout& to) {
    // What was not seen must not darken what was: light counts by its share, and is divided by it afterwards.
    ImageF weighted = sphere.latlong;
    ImageF clipped = sphere.clipped;
    for (int y = 0; y < weighted.height(); ++y) {
        for (int x = 0; x < weighted.width(); ++x) {
            float* pixel = weighted.pixel(x, y);
            for (int c = 0; c < 3; ++c) pixel[c] *= pixel[3];
            if (!clipped.empty()) clipped.at(x, y) *= pixel[3];
        }
    }
    weighted = resample(weighted, from, to);
    if (!clipped.empty()) clipped = resample(clipped, from, to);
    ImageF result(weighted.width(), weighted.height(), clipped.empty() ? 4 : 5);
    for (int y = 0; y < result.height(); ++y) {
        for (int x = 0; x < result.width(); ++x) {
            const float* from_pixel = weighted.pixel(x, y);
            float* pixel = result.pixel(x, y);
            // Rounding leaves a pixel that was seen throughout a hair off 1.
            constexpr float rounding = 1e-4f;
            pixel[3] = from_pixel[3] > 1 - rounding ? 1.0f : from_pixel[3];
            const float gain = pixel[3] > rounding ? 1 / pixel[3] : 0.0f;
            for (int c = 0; c < 3; ++c) pixel[c] = from_pixel[c] * gain;
            if (!clipped.empty()) pixel[4] = std::min(1.0f, clipped.at(x, y) * gain);
        }
    }
    return result;
}

ImageF channels_of(const ImageF& image, int first, int count) {
    ImageF some(image.width(), image.height(), count);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) std::copy_n(image.pixel(x, y) + first, count, some.pixel(x, y));
    }
    return some;
}

Eigen::Vector3d light_at(const SphereView& view, const Eigen::Vector2d& px) {
    return mean_of(view, taps_at(view, px));
}

StitchedSphere stitched_sphere(std::span<const SphereView> views, int height) {
    const int width = 2 * height, points = points_a_side(views, height);
    StitchedSphere result{ImageF(width, height, 4), 0, {}};
    const bool tells_clipped =
        std::ranges::any_of(views, [](const SphereView& view) { return view.clipped != nullptr; });
    if (tells_clipped) result.clipped = ImageF(width, height, 1);
    std::vector<double> seen(static_cast<std::size_t>(height), 0.0), all(seen);
    parallel_for(height, [&](int y) {
        const double middle = std::sin(std::numbers::pi * (y + 0.5) / height);
        // Columns crowd towards the poles: fewer points across keep the lattice square.
        const int across = std::max(2, static_cast<int>(std::ceil(points * middle)));
        for (int x = 0; x < width; ++x) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            double clipped = 0, weight_seen = 0, weight_all = 0;
            for (int j = 0; j < points; ++j) {
                const double row = y + (j + 0.5) / points - 0.5;
                const double solid_angle = std::sin(std::numbers::pi * (row + 0.5) / height);
                for (int i = 0; i < across; ++i) {
                    const double column = x + (i + 0.5) / across - 0.5;
                    weight_all += solid_angle;
                    const Blend blend = blend_at(views, latlong_direction(column, row, width, height));
                    if (blend.weight <= 0) continue;
                    sum += solid_angle / blend.weight * blend.light;
                    clipped += solid_angle * blend.clipped / blend.weight;
                    weight_seen += solid_angle;
                }
            }
            float* pixel = result.latlong.pixel(x, y);
            if (weight_seen > 0) {
                for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(std::max(0.0, sum[c] / weight_seen));
            }
            pixel[3] = static_cast<float>(weight_seen / weight_all);
            if (tells_clipped && weight_seen > 0) result.clipped.at(x, y) = static_cast<float>(clipped / weight_seen);
            seen[static_cast<std::size_t>(y)] += weight_seen / across;
            all[static_cast<std::size_t>(y)] += weight_all / across;
        }
    });
    double seen_sum = 0, all_sum = 0;
    for (std::size_t y = 0; y < seen.size(); ++y) {
        seen_sum += seen[y];
        all_sum += all[y];
    }
    result.seen_share = seen_sum / all_sum;
    return result;
}

}  // namespace matchlight
