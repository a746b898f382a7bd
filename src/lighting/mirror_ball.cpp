// A mirror ball at a finite distance: which way it reflects each ray, and where on it a direction or a place is seen.
#include "lighting/mirror_ball.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace matchlight {
namespace {

/// The angle at a point of the unit ball, `turned` away from the direction of something `distance` (in radii) from the
/// centre, between its normal and the way to that thing. Grows with `turned`, from 0 to π.
double incidence(double turned, double distance) {
    if (std::isinf(distance)) return turned;
    return std::atan2(distance * std::sin(turned), distance * std::cos(turned) - 1);
}

BallHit hit_at(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& normal) {
    BallHit hit;
    hit.normal = normal;
    hit.point_m = ball.centre_m + ball.radius_m * normal;
    const Eigen::Vector3d back = (eye_m - hit.point_m).normalized();
    hit.cosine = back.dot(normal);
    hit.reflected = (2 * hit.cosine * normal - back).normalized();
    return hit;
}

/// By how much `incidence` grows with `turned`; above 0 outside the ball.
double incidence_slope(double turned, double distance) {
    if (std::isinf(distance)) return 1;
    const double cosine = std::cos(turned);
    return distance * (distance - cosine) / (distance * distance - 2 * distance * cosine + 1);
}

/// `target` has unit length and stands `target_distance` radii from the centre. Incidence from eye and target are equal
/// where the difference, which grows with the angle, is 0: by Newton's steps, and by halves where a step would leave
/// the bracket, which never fails.
std::optional<BallHit> solve(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& target,
                             double target_distance) {
    const Eigen::Vector3d to_eye = eye_m - ball.centre_m;
    const double eye_distance = to_eye.norm() / ball.radius_m;
    const Eigen::Vector3d eye = to_eye.normalized();
    const double between = std::atan2(eye.cross(target).norm(), eye.dot(target));
    double low = 0, high = between, turned = between / 2;
    // Sixty halves would do; Newton's steps take five.
    for (int round = 0; round < 60; ++round) {
        const double difference = incidence(turned, eye_distance) - incidence(between - turned, target_distance);
        (difference < 0 ? low : high) = turned;
        const double slope = incidence_slope(turned, eye_distance) + incidence_slope(between - turned, target_distance);
        const double step = difference / slope;
        // The last bit.
        if (std::abs(step) <= 4e-16) break;
        const double next = turned - step;
        turned = next > low && next < high ? next : (low + high) / 2;
    }
    const double angle = std::max(incidence(turned, eye_distance), incidence(between - turned, target_distance));
    if (angle >= std::numbers::pi / 2) return std::nullopt;
    Eigen::Vector3d aside = target - eye.dot(target) * eye;
    const double length = aside.norm();
    // Straight back to the eye: any plane of incidence will do. Straight behind the ball is refused above.
    if (length > std::numeric_limits<double>::min()) aside /= length;
    return hit_at(ball, eye_m, std::cos(turned) * eye + std::sin(turned) * aside);
}

}  // namespace

std::optional<BallHit> hit_ball(const MirrorBall& ball, const Eigen::Vector3d& eye_m,
                                const Eigen::Vector3d& direction) {
    const Eigen::Vector3d to_centre = ball.centre_m - eye_m;
    const double along = to_centre.dot(direction);
    const Eigen::Vector3d aside = to_centre - along * direction;
    const double discriminant = ball.radius_m * ball.radius_m - aside.squaredNorm();
    if (along <= 0 || discriminant <= 0) return std::nullopt;
    const double before = std::sqrt(discriminant);
    return hit_at(ball, eye_m, (-aside - before * direction) / ball.radius_m);
}

std::optional<BallHit> hit_reflecting_direction(const MirrorBall& ball, const Eigen::Vector3d& eye_m,
                                                const Eigen::Vector3d& towards) {
    return solve(ball, eye_m, towards, std::numeric_limits<double>::infinity());
}

std::optional<BallHit> hit_reflecting_place(const MirrorBall& ball, const Eigen::Vector3d& eye_m,
                                            const Eigen::Vector3d& place_m) {
    const Eigen::Vector3d to_place = place_m - ball.centre_m;
    const double distance = to_place.norm();
    if (distance <= ball.radius_m) return std::nullopt;
    return solve(ball, eye_m, to_place / distance, distance / ball.radius_m);
}

double reflected_solid_angle_ratio(const MirrorBall& ball, double distance_m, double cosine) {
    const double distances = 2 * distance_m / ball.radius_m;
    return (1 + distances / cosine) * (1 + distances * cosine);
}

double fresnel_reflectance(double at_normal, double cosine) {
    const double grazing = 1 - std::clamp(cosine, 0.0, 1.0);
    return at_normal + (1 - at_normal) * std::pow(grazing, 5);
}

double miss_ratio(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& direction) {
    const Eigen::Vector3d to_centre = ball.centre_m - eye_m;
    return (to_centre - to_centre.dot(direction) * direction).norm() / ball.radius_m;
}

}  // namespace matchlight
