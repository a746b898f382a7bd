// What is near a mirror ball, as it is seen from the probe's place, and which of the ball's views show it.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/ball_parallax.h"
#include "lighting/ball_probe.h"
#include "lighting/ball_unwrap.h"

namespace matchlight {

/// For two views or more; the scene has to outlive it.
class BallDepth {
public:
    /// Lat-long maps of `height` rows.
    BallDepth(const BallScene& scene, const Eigen::Vector3d& place_m, const BallUnwrap& unwrap, int height);

    /// One over the distance of what the probe's place sees in a pixel, 1/m; 0 far away.
    double nearness(int x, int y) const { return nearness_.at(x, y); }
    int height() const { return nearness_.height(); }

    /// How much of what lies there, 0 to 1, the view shows past what is nearer to the ball.
    double visible(std::size_t v, const Eigen::Vector3d& towards, double nearness) const;

private:
    Eigen::Vector3d place_of(const Eigen::Vector3d& towards, double nearness) const;
    SeenPlace seen(std::size_t v, const Eigen::Vector3d& place_m) const;
    bool farther_is_sure(const BallDepthMap& map, int x, int y, double nearness) const;
    double nearest(const Eigen::Vector3d& towards) const;

    const BallScene& scene_;
    Eigen::Vector3d place_m_;
    std::vector<Eigen::Vector3d> eyes_;
    NearnessScale scale_;
    std::vector<BallDepthMap> maps_;
    ImageF nearness_;
};

}  // namespace matchlight
