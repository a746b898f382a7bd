// How far away what each view of a mirror ball shows is, by its parallax against the other views, which meet the same
// light on other parts of the ball.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/ball_probe.h"
#include "lighting/ball_unwrap.h"
#include "lighting/mirror_ball.h"
#include "lighting/semi_global.h"

namespace matchlight {

/// Stops: what views differ by that show the same, by noise, by compression, and by the different shapes of their
/// pixels where light is not even.
inline constexpr float sure_ev = 0.1F;

/// A view's reflections by their own directions: lat-long, world axes.
struct BallDepthMap {
    ImageF point_m;             // RGB as x y z: where on the ball the direction is reflected
    ImageF light;               // RGB: log2 of radiance
    ImageF known;               // 1 channel: 1 where the view shows the direction well
    ImageF nearness;            // 1 channel, 1/m: one over the distance from point_m; 0 far away
    LabelCosts costs{0, 0, 0};  // stops that the other views' light differs by, at every step of nearness
};

/// Which nearness is told from which. Parallax, in radians, is nearness times how far apart on the ball the views show
/// the same.
struct NearnessScale {
    double step = 0;      // 1/m: half a pixel of the maps
    double far = 0;       // 1/m: what is less near is far away: its parallax is lost in the photographs' pixels
    double farthest = 0;  // 1/m: stands for 0 where a place is needed; its parallax is a millionth of a radian
    int steps = 0;        // the nearest
    double least_sr = 0;  // what is smaller than this is no evidence: costs are means over 3 × 3 pixels

    /// Whether anything is so near that it is told from what is far: not of one view, nor of views from one side.
    bool tells() const { return steps > 0 && far <= steps * step; }
};

NearnessScale nearness_scale(const BallScene& scene, int height);

/// The point of the ball in which an eye sees a place, and the way from there to it.
struct SeenPlace {
    Eigen::Vector3d point_m, towards;
    double nearness = 0;  // 1/m, of the place from the point
};

/// Finds it by bisecting the angle between eye and place again and again, which gains a digit a round for places two
/// radii away; `normal` is where it begins, and the answer's afterwards.
SeenPlace seen_place(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& place_m, int rounds,
                     Eigen::Vector3d& normal);

/// Nearness of the scene's plane along a ray; 0 where the ray does not meet it, or there is none.
double plane_nearness(const BallScene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards);

/// Every pixel the median of those around it, `reach` pixels each way, over the seam: lone errors go, edges stay.
ImageF median_of(const ImageF& latlong, int reach);

/// What is nearer than the plane in so small a region that it is no evidence is as far as the plane.
void drop_specks(ImageF& nearness, const NearnessScale& scale, const std::function<double(int x, int y)>& plane);

/// Of every view, for two views or more. A direction's nearness is the one at which the other views show the same
/// light, and smooth but for jumps (semi_global.h); nothing lies below the plane.
std::vector<BallDepthMap> ball_depth_maps(const BallScene& scene, const BallUnwrap& unwrap, const NearnessScale& scale,
                                          int height);

}  // namespace matchlight
