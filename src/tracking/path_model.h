// The camera's motion as a smooth random process: jitter falls, and nothing lags.
#pragma once

#include <optional>
#include <vector>

#include "tracking/camera_pose.h"

namespace matchlight {

/// What one frame alone says of the camera.
struct PathMeasurement {
    double time_s = 0;
    std::optional<RigidTransform> camera_from_world;         // absent where nothing was seen
    PoseCovariance covariance = PoseCovariance::Identity();  // on the world side
};

struct SmoothPath {
    struct Pose {
        RigidTransform camera_from_world = RigidTransform::Identity();
        PoseCovariance covariance = PoseCovariance::Identity();  // on the world side
    };
    std::vector<std::optional<Pose>> poses;  // from the first measured frame to the last, those between included
};

/// Whole-clip smoothing under a Gaussian-process prior on SE(3): white noise on the acceleration or on the jerk of the
/// camera in its own frame (Tong, Furgale & Barfoot 2013, Gaussian Process Gauss–Newton; Tang, Yoon & Barfoot 2019, A
/// White-Noise-on-Jerk Motion Prior), by Kalman's filter and the smoother of Rauch, Tung & Striebel (1965), which looks
/// as far ahead as back: no lag. Which of the two, and how strong the noise is in turns and in shifts, is what makes
/// the measurements most probable. The noise may change from frame to frame among levels a hundred times apart, up to a
/// cut after which nothing is known: the best sequence of levels is Viterbi's (1967), each survivor with a filter of
/// its own, so that a stop or a shake is followed and calm stretches are smoothed. Where frames are far less certain
/// than the motion is erratic the result is the measurement itself.
SmoothPath smooth_path(const std::vector<PathMeasurement>& measurements);

}  // namespace matchlight
