// A probe from the photographs of a mirror ball: every direction from the views that show it best.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/ball_fit.h"
#include "lighting/ball_rig.h"
#include "lighting/ball_view.h"
#include "lighting/mirror_ball.h"

namespace matchlight {

/// How finely parallax is looked for; the time grows with the cube of the maps' rows.
enum class BallParallax {
    off,     // everything is far away
    coarse,  // in maps of 64 rows: what is near is found, its outline within 3°
    full     // as finely as the ball shows it, in 256 rows at most
};

struct BallProbeOptions {
    int height = 0;         // rows of the lat-long map; 0: what the ball's pixels hold
    double camera_deg = 8;  // around a view's own camera nothing is taken from it, where another view shows it
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  // that the probe is for: the ball's centre, or near it
    BallParallax parallax =
        BallParallax::full;  // find what is near by two views or more, show it as seen from `place_m`
    int samples_a_side = 2;  // directions looked up in a pixel of the map, squared: the ball's pixels are about as fine
};

/// Lat-long, world axes.
struct BallProbe {
    ImageF radiance;           // RGB
    ImageF sigma;              // 1 channel: relative, of luminance
    ImageF seen;               // 1 channel: 1 photographed, 0 filled in
    ImageF clipped;            // 1 channel: 1 where the light is brighter than every photograph could hold
    ImageF nearness = {};      // 1 channel, 1/m: one over the distance from the probe's place; 0 far or not known
    double coverage = 0;       // share of the sphere that is seen
    double clipped_share = 0;  // of the sphere
};

/// What the merge knows of the surroundings.
struct BallScene {
    const std::vector<BallView>& views;
    MirrorBall ball;
    Eigen::Vector3d reflectance = Eigen::Vector3d::Ones();  // head on
    std::optional<RigPlane> plane;                          // with it, what lies on it is seen from `place_m`
    const BallRig* rig = nullptr;                           // whose print fills what the ball hides of it
};

/// Unwraps every view with the ball at its true distance and merges them: a view counts by how finely it shows a
/// direction, not near the ball's rim, and not where it shows its own camera.
///
/// With two views: what is near by their parallax (BallDepth) is shown as it is seen from `place_m`, from the views
/// that see it; so is what lies behind it. Where they stand so close together that parallax tells nothing, and where
/// nothing is near, that changes no bit. `nearness` is empty where neither parallax nor a plane tells any.
///
/// With a plane: a ray that leads down to it ends at a known place, so it is looked up where each view shows that
/// place, reflected or, where reflections are too coarse or hidden, directly; the ball's own shadow is taken off
/// (BallShadow), and what nobody sees of a tag is drawn from its print. Other directions that no view shows are filled
/// from around them and said to be unseen.
BallProbe probe_from_balls(const BallScene& scene, const BallProbeOptions& options);

/// Radians of the surroundings across a pixel in the middle of the ball, where it shows most.
double finest_pixel(const BallView& view, const MirrorBall& ball);

/// Rows of a lat-long map whose pixels are as fine as the finest that the views show, at most 1024.
int natural_height(const std::vector<BallView>& views, const MirrorBall& ball);

}  // namespace matchlight
