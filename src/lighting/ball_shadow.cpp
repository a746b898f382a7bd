// What a mirror ball takes from the light of the plane it stands over, and what it throws onto it.
#include "lighting/ball_shadow.h"

#include <cmath>
#include <optional>

#include "lighting/latlong_grid.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

/// Directions that are blocked are taken a few degrees at a time, as a penumbra is; what the ball reflects down spreads
/// to several times that.
constexpr int fine_rows = 64, coarse_rows = 16;

}  // namespace

BallShadow::BallShadow(const Probe& light, const RigPlane& plane, const MirrorBall& ball,
                       const Eigen::Vector3d& reflectance)
    : plane_(plane), ball_(ball), reflectance_(reflectance), smooth_(resized(light, coarse_rows)) {
    const Probe fine = resized(light, fine_rows);
    const LatlongGrid grid(2 * fine_rows, fine_rows);
    for (int y = 0; y < fine_rows; ++y) {
        for (int x = 0; x < 2 * fine_rows; ++x) {
            Direction direction;
            direction.towards = latlong_direction(x, y, 2 * fine_rows, fine_rows);
            const double cosine = direction.towards.dot(plane.normal);
            if (cosine <= 0) continue;
            direction.weight = cosine * grid.solid_angle(y);
            const Eigen::Map<const Eigen::Vector3f> radiance(fine.latlong.pixel(x, y));
            direction.light_times_cosine = radiance.cast<double>() * direction.weight;
            whole_ += direction.light_times_cosine;
            directions_.push_back(direction);
        }
    }
}

Eigen::Vector3d BallShadow::unshadowed_over_seen(const Eigen::Vector3d& place_m, const GroundLight& ground) const {
    // Past forty radii the ball covers less than a thousandth of the sky.
    if ((place_m - ball_.centre_m).norm() > 40 * ball_.radius_m || whole_.minCoeff() <= 0) {
        return Eigen::Vector3d::Ones();
    }
    Eigen::Vector3d seen = whole_;
    for (const Direction& direction : directions_) {
        const auto hit = hit_ball(ball_, place_m, direction.towards);
        if (!hit) continue;
        const auto below = ground ? plane_.meets(hit->point_m, hit->reflected) : std::nullopt;
        Eigen::Vector3d thrown = below ? ground(*below) : smooth_.radiance(hit->reflected);
        for (int c = 0; c < 3; ++c) thrown[c] *= fresnel_reflectance(reflectance_[c], hit->cosine);
        seen += direction.weight * thrown - direction.light_times_cosine;
    }
    // Right under the ball rounding may leave nothing.
    return whole_.cwiseQuotient(seen.cwiseMax(1e-3 * whole_));
}

}  // namespace matchlight
