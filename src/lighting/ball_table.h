// What lies on the tags' plane under a mirror ball, as it is seen from the probe's place without the ball.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/ball_probe.h"
#include "lighting/ball_shadow.h"
#include "lighting/ball_unwrap.h"
#include "lighting/latlong_grid.h"
#include "lighting/probe.h"

namespace matchlight {

/// For a scene with a plane below `options.place_m`; scene, options and unwrap have to outlive it.
class BallTable {
public:
    /// `first` is the map as first unwrapped, everything far away and nothing left unseen: the light that the ball
    /// keeps from the plane.
    BallTable(const BallScene& scene, const BallProbeOptions& options, const BallUnwrap& unwrap, const ImageF& first);

    /// Where a direction from the probe's place meets the plane; nullopt where it leads up, or so far that the plane is
    /// as good as at infinity.
    std::optional<Eigen::Vector3d> place(const Eigen::Vector3d& towards) const;

    /// Light of the place on the plane that a direction in row `y` of the map shows.
    Gathered light(const Eigen::Vector3d& towards, const Eigen::Vector3d& place_m, int y) const;

    /// Finds the shadow anew: close to the ball the plane is lit by its own reflection in the ball, which only the
    /// plane without its shadow, `found`, tells.
    void follow_reflections(const ImageF& found);

    /// Draws what nobody sees of a tag as printed, in the ink and the paper of what is seen of it.
    void draw_print(BallProbe& probe) const;

private:
    void find_gains(const BallShadow::GroundLight& ground);

    const BallScene& scene_;
    const BallProbeOptions& options_;
    const BallUnwrap& unwrap_;
    LatlongGrid grid_;
    BallShadow shadow_;
    Probe gains_;  // light without the ball over light with it, by directions from the probe's place
};

}  // namespace matchlight
