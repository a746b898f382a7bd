// What one direction or one place looks like in the views of a mirror ball, each by how finely it shows it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "lighting/ball_probe.h"
#include "lighting/ball_view.h"
#include "lighting/mirror_ball.h"

namespace matchlight {

/// Where in a pixel of the map, across and down from its middle, directions are sampled: the middles of its parts.
using MapSamples = std::vector<std::pair<double, double>>;
MapSamples map_samples(int a_side);

/// Weighted light with what is known of it.
struct Gathered {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    double variance = 0;  // of luminance, times weight squared
    double weight = 0;
    double clipped = 0;  // weight of lower bounds

    void add(const Eigen::Vector3d& radiance, double sigma, double w, bool bound) {
        light += w * radiance;
        variance += w * w * sigma * sigma;
        weight += w;
        if (bound) clipped += w;
    }
    void add(const Gathered& other, double w) {
        light += w * other.light;
        variance += w * w * other.variance;
        weight += w * other.weight;
        clipped += w * other.clipped;
    }
};

/// From a place to something that is near: `nearness` is one over its distance, 1/m, and 0 far away.
struct NearRay {
    Eigen::Vector3d from_m, towards;
    double nearness = 0;
};

/// The scene and the options have to outlive it.
class BallUnwrap {
public:
    BallUnwrap(const BallScene& scene, const BallProbeOptions& options);

    /// As if all light came from infinitely far.
    Gathered far_light(const Eigen::Vector3d& towards) const;

    /// Light of what a ray meets; each view counts by how `visible` that is to it.
    Gathered near_light(const NearRay& ray, const std::vector<double>& visible) const;

    /// Light of a place on the plane, as it would be without the ball: times `gain` (BallShadow). `solid_angle` is that
    /// of the output's pixel. Nothing where the place is hidden, or seen in so deep a shadow that the gain would be a
    /// guess.
    Gathered plane_light(const Eigen::Vector3d& place_m, double solid_angle, const Eigen::Vector3d& gain) const;

    /// How well a view shows light from `towards` (as seen from the ball's centre) at `hit`, 0 to 1: nothing outside
    /// the frame and at the rim, next to nothing around its own camera.
    double clearness(std::size_t v, const BallHit& hit, const Eigen::Vector3d& towards) const;

    /// What the view's reflection at `hit` says of light from `towards`, as seen from the ball's centre; weight by how
    /// fine it is, in pixels a square radian.
    void add_reflection(std::size_t v, const BallHit& hit, const Eigen::Vector3d& towards, double share,
                        Gathered& into) const;

private:
    struct Eye {
        Eigen::Vector3d place_m, towards;
        double radius_px = 0;
    };

    /// Steradians that a pixel of the view holds at a hit.
    double pixel_solid_angle(std::size_t v, const BallHit& hit) const;
    void add_direct(std::size_t v, const Eigen::Vector3d& place_m, double share, Gathered& into) const;

    const BallScene& scene_;
    const BallProbeOptions& options_;
    std::vector<Eye> eyes_;
};

}  // namespace matchlight
