// Turning about the plane's normal adds to the last of the three angles, which is the first to be applied of z-y'-x''.
#include "preview/handles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace matchlight {

using Eigen::Vector3d;

namespace {

constexpr double size_knob_at = 1.35, lift_knob_at = 1.0;  // in radii
constexpr double degrees = 180 / std::numbers::pi;

/// To a step of 1 / `steps`: the quotient is the number with the fewest digits, the product would not be.
double rounded(double value, double steps) {
    return std::round(value * steps) / steps;
}

double rounded_to_four_digits(double value) {
    const double digits_behind = 3 - std::floor(std::log10(value));
    const double power = std::pow(10.0, std::abs(digits_behind));
    return digits_behind >= 0 ? rounded(value, power) : std::round(value / power) * power;
}

/// The point of the line that the ray passes nearest to; nullopt where they are all but parallel.
std::optional<Vector3d> nearest_on_line(const Vector3d& point_m, const Vector3d& along, const PixelRay& ray) {
    const Vector3d direction = ray.direction.normalized();
    const double together = along.dot(direction);
    const double apart = 1 - together * together;
    constexpr double least_apart = 1e-3;  // two degrees
    if (apart < least_apart) return std::nullopt;
    const Vector3d from_eye_m = point_m - ray.origin_m;
    const double distance_m = (together * direction.dot(from_eye_m) - along.dot(from_eye_m)) / apart;
    return Vector3d(point_m + distance_m * along);
}

}  // namespace

std::vector<Vector3d> Handles::ring(int points) const {
    const Vector3d x = world_from_parent.linear().col(0).normalized(), y = up().cross(x);
    std::vector<Vector3d> places;
    for (int i = 0; i <= points; ++i) {
        const double angle = 2 * std::numbers::pi * (i % points) / points;
        places.emplace_back(centre_m + radius_m * (std::cos(angle) * x + std::sin(angle) * y));
    }
    return places;
}

Vector3d Handles::size_knob() const {
    return centre_m + size_knob_at * radius_m * world_from_parent.linear().col(0).normalized();
}

Vector3d Handles::lift_knob() const {
    return centre_m + lift_knob_at * radius_m * up();
}

std::optional<HandleDrag> HandleDrag::begin(const Grab& grab, const Placing& before, const Handles& handles,
                                            const PixelRay& ray) {
    HandleDrag drag;
    drag.grab_ = grab;
    drag.before_ = before;
    drag.handles_ = handles;
    const std::optional<Vector3d> reached = drag.reached_m(ray);
    if (!reached) return std::nullopt;
    drag.grab_.point_m = *reached;
    return drag;
}

std::optional<Vector3d> HandleDrag::reached_m(const PixelRay& ray) const {
    const Vector3d up = handles_.up();
    if (grab_.grip == Grip::lift) return nearest_on_line(handles_.centre_m, up, ray);
    return meet(ray, grab_.grip == Grip::move ? Plane(up, grab_.point_m) : handles_.plane());
}

std::optional<Placing> HandleDrag::to(const PixelRay& ray) const {
    const std::optional<Vector3d> reached = reached_m(ray);
    if (!reached) return std::nullopt;
    Placing placing = before_;
    const Vector3d from = grab_.point_m - handles_.centre_m, to = *reached - handles_.centre_m;
    switch (grab_.grip) {
        case Grip::move:
        case Grip::lift: {
            placing.translate_m += handles_.world_from_parent.linear().inverse() * (*reached - grab_.point_m);
            for (double& metres : placing.translate_m) metres = rounded(metres, 1e5);
            break;
        }
        case Grip::turn: {
            constexpr double full_turn_deg = 360;
            const double angle = std::atan2(handles_.up().dot(from.cross(to)), from.dot(to)) * degrees;
            placing.rotate_deg.z() = rounded(std::remainder(placing.rotate_deg.z() + angle, full_turn_deg), 100);
            break;
        }
        case Grip::size: {
            constexpr double least = 0.01, most = 100;  // of one drag
            if (from.norm() == 0) return std::nullopt;
            const double factor = std::clamp(to.norm() / from.norm(), least, most);
            for (double& scale : placing.scale) scale = rounded_to_four_digits(scale * factor);
            break;
        }
    }
    return placing;
}

}  // namespace matchlight
