// Sums over the middles of strata.
#include "report/near_light_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace matchlight {

namespace {

/// Calls `body(u, v)` for the middles of strata² cells of the unit square.
template <class Body>
void over_square(int strata, const Body& body) {
    for (int i = 0; i < strata; ++i) {
        for (int j = 0; j < strata; ++j) body((i + 0.5) / strata, (j + 0.5) / strata);
    }
}

/// With the third axis along the normal.
Eigen::Matrix3d frame_about(const Eigen::Vector3d& normal) {
    Eigen::Matrix3d frame;
    frame.col(2) = normal.normalized();
    frame.col(0) = frame.col(2).unitOrthogonal();
    frame.col(1) = frame.col(2).cross(frame.col(0));
    return frame;
}

double smith_lambda(double cosine, double alpha) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

}  // namespace

Eigen::Vector3d reference_mirrored(const LobeView& lobe, int strata, const SeenAlong& seen) {
    const Eigen::Matrix3d world_from_surface = frame_about(lobe.normal);
    const Eigen::Vector3d eye = world_from_surface.transpose() * lobe.towards_eye.normalized();
    if (!(eye.z() > 0)) return Eigen::Vector3d::Zero();
    const double alpha = lobe.roughness * lobe.roughness;
    const double eye_lambda = smith_lambda(eye.z(), alpha);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    over_square(strata, [&](double u, double v) {
        const double tangent = alpha * std::sqrt(u / (1 - u));
        const double phi = 2 * std::numbers::pi * v;
        const Eigen::Vector3d half = Eigen::Vector3d(tangent * std::cos(phi), tangent * std::sin(phi), 1).normalized();
        const double cosine = eye.dot(half);
        const Eigen::Vector3d along = 2 * cosine * half - eye;
        if (cosine <= 0 || along.z() <= 0) return;
        const double masking = 1 / (1 + eye_lambda + smith_lambda(along.z(), alpha));
        const double fresnel = lobe.reflectance + (1 - lobe.reflectance) * std::pow(1 - cosine, 5);
        sum += fresnel * masking * cosine / (eye.z() * half.z()) * seen(world_from_surface * along);
    });
    return sum / (static_cast<double>(strata) * strata);
}

Eigen::Vector3d reference_gathered(const Eigen::Vector3d& normal, int strata, const SeenAlong& seen) {
    const Eigen::Matrix3d world_from_surface = frame_about(normal);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    over_square(strata, [&](double u, double v) {
        const double radius = std::sqrt(u), phi = 2 * std::numbers::pi * v;
        sum += seen(world_from_surface *
                    Eigen::Vector3d(radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1 - u)));
    });
    return sum / (static_cast<double>(strata) * strata);
}

}  // namespace matchlight
