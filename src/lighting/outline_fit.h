// Fits the outline of a ball, robustly, to the edges across it in a picture.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "calibration/camera.h"
#include "lighting/ball_outline.h"

namespace matchlight {

/// An edge across the outline: where along the outward normal (pixels from the outline) and how strong.
struct OutlineEdge {
    int profile = 0;
    double offset_px = 0;
    double strength = 0;
};

/// One candidate, with the edges around it. `light` holds logarithms of RGB light.
class OutlineFit {
public:
    OutlineFit(const cv::Mat& light, const Camera& camera, const BallOutline& start);

    /// From a proposal of Hough's transform, which is off by a few per cent, to where most edges lie. False when there
    /// is nothing to follow.
    bool settle();

    /// Onto the edges. False when they end.
    bool refine();

    const BallOutline& outline() const { return outline_; }

private:
    float sample(const Eigen::Vector2d& at, int channel) const;

    void gather(double reach_px);

    Eigen::Vector2d normal_at(const Eigen::Matrix3d& frame, double turn) const;

    /// How far the outline moves along its normal with a turn of the axis about v and u and with the half angle.
    Eigen::Vector3d derivative(const Eigen::Matrix3d& frame, double turn, const Eigen::Vector2d& normal) const;

    void move(const Eigen::Vector3d& by);

    std::vector<Eigen::Vector3d> derivatives() const;

    /// Moves the outline to where most profiles have an edge: shifts are tried on a grid, and for each the offsets that
    /// remain vote for the radius. First over the whole band, then finely around the best.
    bool move_to_consensus();

    /// How many profiles have an edge within a bin of one radius, and which.
    std::pair<int, double> vote(const std::vector<Eigen::Vector2d>& normals, const Eigen::Vector2d& shift,
                                double bin_px, int bins) const;

    /// One step of least squares with Tukey's weights over the edge nearest to the outline in each profile.
    bool step();

    /// By how many standard deviations more profiles have an edge on the outline than beside it: what large and small
    /// circles, quiet and noisy pictures can be compared by.
    double significance(int on_it) const;

    const cv::Mat& light_;
    const Camera& camera_;
    BallOutline outline_;
    int profiles_ = 0;
    int in_frame_ = 0;
    double band_px_ = 1;
    std::vector<OutlineEdge> edges_;
};

/// A frame about the axis: columns u, v and axis.
Eigen::Matrix3d frame_about(const Eigen::Vector3d& axis);
/// The pixel of the cone of `half_angle` about the frame's axis, at `turn` from u towards v.
Eigen::Vector2d outline_pixel(const Camera& camera, const Eigen::Matrix3d& frame, double half_angle, double turn);

}  // namespace matchlight
