// Regular polygons with rounded sides.
#include "render/effects/bokeh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace matchlight {

namespace {

using std::numbers::pi;

/// Of the polygon's straight sides.
double polygon_distance(const BokehSettings& bokeh, const Eigen::Vector2d& point) {
    const double side_rad = 2 * pi / bokeh.blades;
    // y counts downwards, the rotation is counter-clockwise as seen: hence the sign. A corner points to the angle 0.
    const double angle = std::atan2(-point.y(), point.x()) - bokeh.rotation_deg * pi / 180;
    const double from_side = angle - side_rad * (std::floor(angle / side_rad) + 0.5);
    return point.norm() * std::cos(from_side) / std::cos(side_rad / 2);
}

}  // namespace

double bokeh_distance(const BokehSettings& bokeh, const Eigen::Vector2d& point) {
    const double round = point.norm();
    if (bokeh.blades < 3 || round == 0) return round;
    return std::lerp(polygon_distance(bokeh, point), round, bokeh.roundness);
}

double bokeh_area(const BokehSettings& bokeh) {
    if (bokeh.blades < 3) return pi;
    // ∫ ½ ρ(θ)² dθ, ρ where the distance is 1; smooth between corners, so few steps a side suffice.
    constexpr int steps = 256;
    const double side_rad = 2 * pi / bokeh.blades;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double from_side = side_rad * ((i + 0.5) / steps - 0.5);
        const double distance = std::lerp(std::cos(from_side) / std::cos(side_rad / 2), 1.0, bokeh.roundness);
        sum += 1 / (distance * distance);
    }
    return pi * sum / steps;
}

std::vector<Eigen::Vector2d> lens_points(const BokehSettings& bokeh, int count) {
    assert(count > 0);
    std::vector<Eigen::Vector2d> points;
    if (bokeh.blades < 3) {
        const double golden_angle = pi * (3 - std::sqrt(5.0));
        for (int i = 0; i < count; ++i) {
            const double radius = std::sqrt((i + 0.5) / count);
            points.emplace_back(radius * std::cos(i * golden_angle), radius * std::sin(i * golden_angle));
        }
    } else {
        constexpr double plastic = 1.32471795724474602596;
        for (int i = 0; static_cast<int>(points.size()) < count; ++i) {
            double whole = 0;
            const Eigen::Vector2d point(2 * std::modf(0.5 + i / plastic, &whole) - 1,
                                        2 * std::modf(0.5 + i / (plastic * plastic), &whole) - 1);
            if (bokeh_distance(bokeh, point) <= 1) points.push_back(point);
        }
    }
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& point : points) mean += point / count;
    for (Eigen::Vector2d& point : points) point -= mean;
    return points;
}

}  // namespace matchlight
