// Where a solve is weak: residuals by frame and by tag, and the frames that deserve a look, worst first.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tracking/solve_file.h"
#include "tracking/track_details.h"

namespace matchlight {

/// One tag in one frame.
struct TagResidual {
    int id = 0;
    TagCorners observed_px;
    TagCorners residual_px;  // observed minus projected; in frames with a pose
    bool used = false;       // the pose rests on it
};

struct FrameResiduals {
    std::vector<TagResidual> tags;  // of the rig
    /// What the pose's covariance makes of the rig's corners in the picture: standard deviation, RMS over them.
    std::optional<double> predicted_px;
};

/// One tag over the clip, in the frames whose pose rests on it.
struct TagFindings {
    int id = 0;
    std::int64_t frames = 0;
    double rms_px = 0;
    Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();  // not 0: the tag's place or size is off, or the lens
    double worst_px = 0;                                // RMS of its worst frame
    std::int64_t worst_frame = 0;
};

/// Frames in a row that are doubtful for one reason.
struct FlaggedRun {
    std::string reason;       // "no pose", "residuals far above the clip's"
    std::string worst_value;  // of the worst frame: "2.31 px (median of the clip 0.05 px)"
    std::int64_t first = 0, last = 0, worst = 0;
};

struct SolveFindings {
    std::vector<FrameResiduals> frames;  // parallel to the solve's
    std::vector<TagFindings> tags;       // in the rig's order
    std::vector<FlaggedRun> flagged;     // worst reason first
    std::optional<double> median_reprojection_px;
};

SolveFindings find_weak_points(const Solve& solve, const TrackDetails& details);

/// Standard deviation that `covariance` of the pose gives the rig's corners in the undistorted picture, RMS over the
/// corners in front of the camera; nullopt where there is none.
std::optional<double> predicted_error_px(const Solve& solve, const RigidTransform& camera_from_world,
                                         const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace matchlight
