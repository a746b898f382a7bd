// The place of a mirror ball to a fraction of a millimetre: what it reflects of a plane is compared with the plane
// itself.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "lighting/ball_rig.h"
#include "lighting/ball_view.h"
#include "lighting/mirror_ball.h"

namespace matchlight {

/// The surface that the tags lie on.
struct RigPlane {
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();

    double height_m(const Eigen::Vector3d& place_m) const { return normal.dot(place_m - point_m); }
    /// Where the ray from `from_m` meets it; nullopt when it leads away.
    std::optional<Eigen::Vector3d> meets(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction) const;
};

/// nullopt when the tags lie on different planes: a fiftieth of their extent apart, or turned by more than 3°.
std::optional<RigPlane> plane_of_rig(const BallRig& rig);

struct BallFit {
    MirrorBall ball;  // world
    /// What the ball sends back head on, RGB; nullopt where too little of the plane is seen both ways.
    std::optional<Eigen::Vector3d> reflectance;
    double residual = 0;        // median of |log2(reflected / seen directly)|, after the reflectance
    std::size_t points = 0;     // of the plane that were seen both ways
    double outline_off_px = 0;  // how far the outlines' own places lie from it, the worst view
};

/// The ball that explains best what every view's reflection shows of the plane, from the place that the outlines say
/// and from the plane below it. Points of the plane that a view shows both directly and in the ball have to differ by
/// one factor, the reflectance; a step of the light, such as a tag's edge, moves in the reflection when the ball does.
/// nullopt where fewer than 60 points are seen both ways.
std::optional<BallFit> fit_ball_to_rig(const std::vector<BallView>& views, const BallRig& rig, const RigPlane& plane,
                                       const MirrorBall& start);

/// A place on the plane as the views see it directly, RGB: the mean of those that do. nullopt where none does.
std::optional<Eigen::Vector3d> direct_radiance(const std::vector<BallView>& views, const MirrorBall& ball,
                                               const Eigen::Vector3d& place_m);

/// The place that the outlines say together: each is sure across its line of sight and less so along it.
MirrorBall ball_from_outlines(const std::vector<BallView>& views, double radius_m);

}  // namespace matchlight
