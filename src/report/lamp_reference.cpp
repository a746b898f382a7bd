// Directions of equal solid angle on a spiral.
#include "report/lamp_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace matchlight {

namespace {

constexpr double pi = std::numbers::pi;

double radians(double degrees) {
    return degrees * pi / 180;
}

/// What a lamp sends to what faces it, and half the angle that it is seen under.
struct Arrival {
    Eigen::Vector3d to_lamp;
    Eigen::Vector3d irradiance;
    double half_angle = 0;
    double distance_m = 1e30;
};

Arrival arrival_at(const LampSettings& lamp, const Eigen::Vector3d& point_m) {
    const Eigen::Vector3d light = lamp.intensity * lamp.color;
    const Eigen::Vector3d axis = lamp.direction.normalized();
    if (lamp.type == LampType::directional) return {-axis, light, radians(lamp.angle_deg) / 2};
    const Eigen::Vector3d way = lamp.position_m - point_m;
    const double distance = std::max({way.norm(), lamp.radius_m, 1e-3});
    Eigen::Vector3d irradiance = light / (distance * distance);
    if (lamp.range_m) irradiance *= std::clamp(1 - std::pow(distance / *lamp.range_m, 4), 0.0, 1.0);
    if (lamp.type == LampType::spot) {
        const double inner = std::cos(radians(lamp.inner_cone_deg)), outer = std::cos(radians(lamp.outer_cone_deg));
        const double at = -way.normalized().dot(axis);
        const double share = lamp.outer_cone_deg == 0 ? 0 : (at - outer) / std::max(inner - outer, 1e-3);
        irradiance *= std::pow(std::clamp(share, 0.0, 1.0), 2);
    }
    return {way.normalized(), irradiance, std::asin(std::min(lamp.radius_m / distance, 1.0)), way.norm()};
}

}  // namespace

Eigen::Vector3d reference_lamp_irradiance(const LampSettings& lamp, const Eigen::Vector3d& point_m,
                                          const Eigen::Vector3d& normal, const Blocked& blocked, int rays) {
    const Arrival arrival = arrival_at(lamp, point_m);
    const auto sees = [&](const Eigen::Vector3d& direction) {
        return !lamp.casts_shadow || !blocked(point_m, point_m + arrival.distance_m * direction);
    };
    if (arrival.half_angle == 0) {
        const double cosine = std::max(normal.dot(arrival.to_lamp), 0.0);
        return cosine > 0 && sees(arrival.to_lamp) ? Eigen::Vector3d(cosine * arrival.irradiance)
                                                   : Eigen::Vector3d::Zero();
    }
    // An even disc of half angle a has the irradiance π L sin² a over what faces it, and the solid angle 2π (1 − cos
    // a).
    const double cone = 1 - std::cos(arrival.half_angle);
    const Eigen::Vector3d radiance = arrival.irradiance / (pi * std::pow(std::sin(arrival.half_angle), 2));
    const Eigen::Vector3d right = arrival.to_lamp.unitOrthogonal(), up = arrival.to_lamp.cross(right);
    double seen = 0;
    for (int i = 0; i < rays; ++i) {
        const double cosine = 1 - cone * (i + 0.5) / rays;
        const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0)), angle = i * pi * (3 - std::sqrt(5.0));
        const Eigen::Vector3d direction =
            cosine * arrival.to_lamp + sine * (std::cos(angle) * right + std::sin(angle) * up);
        const double falls = normal.dot(direction);
        if (falls > 0 && sees(direction)) seen += falls;
    }
    return seen / rays * 2 * pi * cone * radiance;
}

}  // namespace matchlight
