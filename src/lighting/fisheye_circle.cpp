// Rays from the frame inwards stop where the picture begins; the circle is what most of them agree on.
#include "lighting/fisheye_circle.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "core/transfer.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

double luminance_at(const ImageF& light, int x, int y) {
    const float* p = light.pixel(x, y);
    return luminance_rec709(p[0], p[1], p[2]);
}

double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, at);
    return *at;
}

/// Luminance above which a pixel belongs to the picture rather than to its frame; nullopt where the corners are as
/// bright as the middle.
std::optional<double> frame_threshold(const ImageF& light, const Region& region) {
    std::vector<double> corners, middle;
    // A circle that touches the frame's sides leaves a square of 0.146 of a side free in each corner.
    const int margin = std::max(2, std::min(region.width, region.height) / 12);
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            const double luminance = luminance_at(light, region.x + x, region.y + y);
            const bool at_side = x < margin || x >= region.width - margin;
            const bool at_end = y < margin || y >= region.height - margin;
            if (at_side && at_end) corners.push_back(luminance);
            if (std::abs(2 * x - region.width) < region.width / 2 &&
                std::abs(2 * y - region.height) < region.height / 2)
                middle.push_back(luminance);
        }
    }
    if (corners.empty() || middle.empty()) return std::nullopt;
    const double dark = quantile(corners, 0.99), bright = quantile(middle, 0.5);
    if (!(bright > 0) || dark > 0.1 * bright) return std::nullopt;
    // Above the frame's noise and stray light, and above what a lens' haze leaves at its rim.
    return std::max(3 * dark, 0.01 * bright);
}

/// Where the picture begins on a line of luminances that runs from the frame inwards, in samples; nullopt where it
/// begins at the frame itself, or not at all.
std::optional<double> first_edge(const std::vector<double>& line, double threshold) {
    const auto first = std::ranges::find_if(line, [&](double value) { return value > threshold; });
    const std::ptrdiff_t at = first - line.begin();
    constexpr std::ptrdiff_t plateau = 6;  // samples past the edge that tell how bright the rim is
    if (at < 2 || at + plateau >= static_cast<std::ptrdiff_t>(line.size())) return std::nullopt;
    double inside = 0;
    for (std::ptrdiff_t i = 3; i <= plateau; ++i) inside += line[static_cast<std::size_t>(at + i)] / (plateau - 2);
    // The lens' edge lies where half of the rim's light is reached.
    const double half = std::max(inside / 2, threshold / 2);
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(at - 2, 1); i <= at + 3; ++i) {
        const double before = line[static_cast<std::size_t>(i - 1)], after = line[static_cast<std::size_t>(i)];
        if (before <= half && after > half) return static_cast<double>(i - 1) + (half - before) / (after - before);
    }
    return std::nullopt;
}

std::vector<Vector2d> edge_points(const ImageF& light, const Region& region, double threshold) {
    const Vector2d centre(region.x + (region.width - 1) / 2.0, region.y + (region.height - 1) / 2.0);
    std::vector<Vector2d> points;
    constexpr int rays = 720;
    for (int ray = 0; ray < rays; ++ray) {
        const double angle = 2 * std::numbers::pi * ray / rays;
        const Vector2d direction(std::cos(angle), std::sin(angle));
        const double reach = std::min((region.width - 1) / 2.0 / std::max(1e-9, std::abs(direction.x())),
                                      (region.height - 1) / 2.0 / std::max(1e-9, std::abs(direction.y())));
        std::vector<double> line;
        for (double r = std::floor(reach); r > 0; --r) {
            const Vector2d at = centre + r * direction;
            const int x = std::clamp(static_cast<int>(std::floor(at.x())), region.x, region.x + region.width - 2);
            const int y = std::clamp(static_cast<int>(std::floor(at.y())), region.y, region.y + region.height - 2);
            const double u = at.x() - x, v = at.y() - y;
            line.push_back((1 - v) * ((1 - u) * luminance_at(light, x, y) + u * luminance_at(light, x + 1, y)) +
                           v * ((1 - u) * luminance_at(light, x, y + 1) + u * luminance_at(light, x + 1, y + 1)));
        }
        const std::optional<double> edge = first_edge(line, threshold);
        if (edge) points.emplace_back(centre + (std::floor(reach) - *edge) * direction);
    }
    return points;
}

/// Least squares on x² + y² + a x + b y + c = 0 (Kåsa 1976), about the points' mean.
PixelCircle circle_through(const std::vector<Vector2d>& points) {
    Vector2d mean = Vector2d::Zero();
    for (const Vector2d& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Vector2d& p : points) {
        const Eigen::Vector3d row((p - mean).x(), (p - mean).y(), 1);
        normal += row * row.transpose();
        right -= row * (p - mean).squaredNorm();
    }
    const Eigen::Vector3d abc = normal.ldlt().solve(right);
    const Vector2d offset = -abc.head<2>() / 2;
    return {mean + offset, std::sqrt(std::max(0.0, offset.squaredNorm() - abc.z()))};
}

std::vector<Vector2d> points_on(const PixelCircle& circle, const std::vector<Vector2d>& points, double tolerance_px) {
    std::vector<Vector2d> on;
    std::ranges::copy_if(points, std::back_inserter(on), [&](const Vector2d& p) {
        return std::abs((p - circle.centre_px).norm() - circle.radius_px) < tolerance_px;
    });
    return on;
}

}  // namespace

std::optional<PixelCircle> find_fisheye_circle(const ImageF& light, const Region& region) {
    constexpr int smallest_side = 32;
    if (std::min(region.width, region.height) < smallest_side) return std::nullopt;
    const std::optional<double> threshold = frame_threshold(light, region);
    if (!threshold) return std::nullopt;
    const std::vector<Vector2d> points = edge_points(light, region, *threshold);
    constexpr std::size_t fewest = 90;  // an eighth of the rays
    if (points.size() < fewest) return std::nullopt;
    const double tolerance_px = std::max(1.5, 0.003 * std::min(region.width, region.height));
    // Three points far apart make a circle; the best of many such is what most points lie on (Fischler & Bolles 1981).
    std::vector<Vector2d> best;
    std::uint32_t state = 1;
    const auto next = [&] {
        state = state * 1664525u + 1013904223u;  // Numerical Recipes' generator: any will do, but always the same
        return static_cast<std::size_t>(state >> 8) % points.size();
    };
    constexpr int trials = 400;  // with half of the points astray, all 400 miss with a chance of 1e-23
    for (int trial = 0; trial < trials; ++trial) {
        const std::vector<Vector2d> three = {points[next()], points[next()], points[next()]};
        const PixelCircle circle = circle_through(three);
        if (!(circle.radius_px > 0.15 * std::min(region.width, region.height)) ||
            circle.radius_px > 2.0 * std::max(region.width, region.height)) {
            continue;
        }
        std::vector<Vector2d> on = points_on(circle, points, tolerance_px);
        if (on.size() > best.size()) best = std::move(on);
    }
    if (best.size() < fewest || 2 * best.size() < points.size()) return std::nullopt;
    PixelCircle circle = circle_through(best);
    for (int pass = 0; pass < 3; ++pass) circle = circle_through(points_on(circle, points, tolerance_px));
    return circle;
}

}  // namespace matchlight
