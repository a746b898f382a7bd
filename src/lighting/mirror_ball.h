// A mirror ball at a finite distance: which way it reflects each ray, and where on it a direction or a place is seen.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace matchlight {

/// In the frame that its centre is given in.
struct MirrorBall {
    Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
    double radius_m = 0;
};

/// Where a ray meets the ball.
struct BallHit {
    Eigen::Vector3d point_m;
    Eigen::Vector3d normal;
    Eigen::Vector3d reflected;  // unit length: where the light comes from that the ray sees
    double cosine = 0;          // between normal and the way back to the eye
};

/// The first hit of the ray from `eye_m` along `direction` (unit length); nullopt where it misses. The discriminant is
/// taken from the distance of the centre from the ray, which holds at any distance (Haines, Günther & Akenine-Möller
/// 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7).
std::optional<BallHit> hit_ball(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& direction);

/// The point of the ball in which `eye_m` sees light that comes from infinitely far along `towards` (unit length, from
/// the ball outwards). Every direction is seen somewhere but the ball's own shadow straight behind it: nullopt there.
std::optional<BallHit> hit_reflecting_direction(const MirrorBall& ball, const Eigen::Vector3d& eye_m,
                                                const Eigen::Vector3d& towards);

/// The same for a place at a finite distance (Alhazen's problem), outside the ball; nullopt where the ball itself hides
/// the place from the points that `eye_m` sees, or the place lies inside.
std::optional<BallHit> hit_reflecting_place(const MirrorBall& ball, const Eigen::Vector3d& eye_m,
                                            const Eigen::Vector3d& place_m);

/// Steradians of the surroundings that one steradian of the eye's view shows, at a hit `distance_m` from the eye: how
/// much the ball shrinks them. The reflected direction turns by 1 + 2·distance/(radius·cosine) for each radian of the
/// view within the plane of incidence, and by 1 + 2·distance·cosine/radius across it.
double reflected_solid_angle_ratio(const MirrorBall& ball, double distance_m, double cosine);

/// Share of light that metal sends back: `at_normal` head on, all of it at grazing incidence (Schlick 1994, "An
/// Inexpensive BRDF Model for Physically-based Rendering", eq. 15).
double fresnel_reflectance(double at_normal, double cosine);

/// The share of the way of a ray past the ball: distance of the ball's centre from the ray, over its radius.
double miss_ratio(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& direction);

}  // namespace matchlight
