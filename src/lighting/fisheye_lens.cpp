// The formulas of the projections.
#include "lighting/fisheye_lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace matchlight {

double FisheyeLens::radius_of(double angle) const {
    switch (projection) {
        case FisheyeProjection::equidistant:
            return angle;
        case FisheyeProjection::equisolid:
            return 2 * std::sin(angle / 2);
        case FisheyeProjection::orthographic:
            return std::sin(angle);
        case FisheyeProjection::stereographic:
            return 2 * std::tan(angle / 2);
        case FisheyeProjection::kannala_brandt:
            break;
    }
    const double square = angle * angle;
    return angle * (1 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3]))));
}

std::optional<Eigen::Vector2d> FisheyeLens::pixel_from_direction(const Eigen::Vector3d& direction) const {
    const double across = direction.head<2>().norm(), angle = std::atan2(across, direction.z());
    if (angle > most_angle) return std::nullopt;
    if (across == 0) return centre_px;
    return Eigen::Vector2d(centre_px + radius_of(angle) / across * focal_px.cwiseProduct(direction.head<2>()));
}

double widest_angle(const FisheyeLens& lens) {
    switch (lens.projection) {
        case FisheyeProjection::orthographic:
            return std::numbers::pi / 2;
        case FisheyeProjection::equidistant:
        case FisheyeProjection::equisolid:
            return std::numbers::pi;
        case FisheyeProjection::stereographic:
            // Straight backwards lies infinitely far out; at 170° the picture is 23 focal lengths wide already.
            return 170 * std::numbers::pi / 180;
        case FisheyeProjection::kannala_brandt:
            break;
    }
    // The polynomial is good as long as it rises.
    constexpr double step = 1e-3;
    double angle = step;
    while (angle < std::numbers::pi && lens.radius_of(angle) > lens.radius_of(angle - step)) angle += step;
    return angle - step;
}

double finest_scale(const FisheyeLens& lens) {
    double finest = 1;
    constexpr double step = 0.01;
    // Near straight backwards a point becomes the whole rim: three times as fine as in the middle is enough there.
    constexpr double finest_of_use = 3;
    for (double angle = step; angle < lens.most_angle; angle += step) {
        const double along = (lens.radius_of(angle) - lens.radius_of(angle - step)) / step;
        finest = std::max({finest, along, lens.radius_of(angle) / std::max(1e-3, std::sin(angle))});
    }
    return std::min(finest, finest_of_use);
}

FisheyeLens lens_of_circle(FisheyeProjection projection, const PixelCircle& circle, double fov) {
    FisheyeLens lens;
    lens.projection = projection;
    lens.centre_px = circle.centre_px;
    lens.most_angle = fov / 2;
    lens.focal_px = Eigen::Vector2d::Constant(circle.radius_px / lens.radius_of(lens.most_angle));
    return lens;
}

}  // namespace matchlight
