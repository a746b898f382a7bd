// What a report says of tracking: error against run time of the solve's levels and of other libraries' poses.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report/measured_time.h"

namespace matchlight {

/// Of a solve, or of poses alone, against exact truth. Registration errors are means over the corners of the object
/// volume, in pixels of the calibrated pinhole.
struct TrackErrors {
    double mean_px = 0, median_px = 0, p95_px = 0, max_px = 0;
    std::optional<double> slow_mean_px, fast_mean_px;  // of frames in which the volume moves under or over 8 px
    std::optional<double> jitter_px;    // RMS of the change of the signed error between consecutive frames
    std::optional<double> nees_median;  // normalised error squared over its six degrees of freedom
    std::optional<double> ev_mean, ev_spread;
    std::optional<double> white_balance;     // mean of the largest relative error of a channel
    std::optional<double> focus, coc_scale;  // mean relative error
    std::optional<double> shutter;           // mean absolute error
    std::int64_t lost = 0;                   // frames with a true pose and none of ours
};

/// How well the tags of a clip agree with each other, which real footage tells without a truth.
struct TagAgreement {
    std::optional<double> reprojection_px;   // RMS over all corners
    std::optional<double> leave_one_out_px;  // RMS of a tag's corners under the pose that the frame's others have
    std::optional<double> leave_one_out_median_px;  // of the RMS of each frame's each tag
    std::optional<double> leave_one_out_jitter_px;  // RMS of the change of that tag's mean error between frames
};

/// One way to track the clip.
struct TrackPoint {
    std::string name;  // "final"; the point's label
    std::string what;  // one line
    RunTime time;      // of the whole clip, decoding included
    std::int64_t posed = 0;
    std::optional<TrackErrors> errors;  // where the truth is known
    TagAgreement agreement;
    std::vector<std::optional<double>> error_px;  // of every frame with a true pose; for the page
};

struct TrackReport {
    std::int64_t frames = 0;
    bool against_truth = false;
    std::vector<TrackPoint> points;

    /// What the plot's height shows: the mean error against the truth, or leaving one tag out.
    std::optional<double> error_of(const TrackPoint& point) const {
        if (against_truth) return point.errors ? std::optional(point.errors->mean_px) : std::nullopt;
        return point.agreement.leave_one_out_px;
    }
};

}  // namespace matchlight
