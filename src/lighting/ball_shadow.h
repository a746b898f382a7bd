// What a mirror ball takes from the light of the plane it stands over, and what it throws onto it.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "lighting/ball_fit.h"
#include "lighting/mirror_ball.h"
#include "lighting/probe.h"

namespace matchlight {

/// Irradiance of the plane with and without the ball, from what the ball itself shows of the light above the plane,
/// taken as far away, and, below the horizon, of the plane. In the ball's shadow the light that it reflects down
/// counts.
class BallShadow {
public:
    /// `light` is the probe as first unwrapped, without any repair of the plane; `reflectance` head on.
    BallShadow(const Probe& light, const RigPlane& plane, const MirrorBall& ball, const Eigen::Vector3d& reflectance);

    /// Radiance of the plane at a place, in the ball's shadow.
    using GroundLight = std::function<Eigen::Vector3d(const Eigen::Vector3d& place_m)>;

    /// Irradiance without the ball over irradiance with it at a place on the plane, RGB; above 1 in the shadow. Close
    /// to the ball much of what is left comes from the plane itself by way of the ball's underside: by `ground`, or
    /// else as if it came from far below.
    Eigen::Vector3d unshadowed_over_seen(const Eigen::Vector3d& place_m, const GroundLight& ground = {}) const;

    /// Of the plane, RGB.
    const Eigen::Vector3d& irradiance_without_ball() const { return whole_; }

private:
    struct Direction {
        Eigen::Vector3d towards;
        Eigen::Vector3d light_times_cosine;  // radiance × solid angle × cosine
        double weight = 0;                   // solid angle × cosine
    };

    RigPlane plane_;
    MirrorBall ball_;
    Eigen::Vector3d reflectance_;
    std::vector<Direction> directions_;
    Eigen::Vector3d whole_ = Eigen::Vector3d::Zero();
    Probe smooth_;
};

}  // namespace matchlight
