// Short runs of frames without a tag.
#include <algorithm>
#include <cmath>

#include "tracking/camera_path.h"

namespace matchlight {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t longest_bridge_frames = 5;
constexpr double longest_bridge_s = 0.25;

bool measured(const PathFrame& frame) {
    return frame.pose && !frame.bridged;
}

/// Perturbation a second, from one measured frame to the next.
Vector6 velocity(const PathFrame& from, const PathFrame& to) {
    return perturbation_between(from.pose->camera_from_world, to.pose->camera_from_world) /
           std::max(to.time_s - from.time_s, 1e-6);
}

struct Bridge {
    const PathFrame *before, *first, *last, *after;  // outer ones may be null
};

void fill(const Bridge& bridge, PathFrame& frame) {
    const double duration = bridge.last->time_s - bridge.first->time_s;
    const double t = std::clamp((frame.time_s - bridge.first->time_s) / std::max(duration, 1e-6), 0.0, 1.0);
    const RigidTransform& start = bridge.first->pose->camera_from_world;
    const Vector6 whole = perturbation_between(start, bridge.last->pose->camera_from_world);
    const Vector6 straight = t * whole;
    Vector6 curved = straight;
    if (bridge.before && bridge.after) {
        const Vector6 leaving = velocity(*bridge.before, *bridge.first) * duration;
        const Vector6 arriving = velocity(*bridge.last, *bridge.after) * duration;
        curved = (3 * t * t - 2 * t * t * t) * whole + (t - 2 * t * t + t * t * t) * leaving +
                 (t * t * t - t * t) * arriving;
    }
    CameraPose pose;
    pose.camera_from_world = perturbed(start, curved);
    // What the path may have done meanwhile: as much as the two guesses differ, and a tenth of the way at least.
    const Vector6 unknown = (curved - straight).cwiseAbs() + 0.4 * t * (1 - t) * whole.cwiseAbs();
    pose.covariance = (1 - t) * bridge.first->pose->covariance + t * bridge.last->pose->covariance;
    pose.covariance.diagonal() += unknown.cwiseProduct(unknown);
    frame.pose = pose;
    frame.bridged = true;
    frame.confidence = 0.5 * std::min(bridge.first->confidence, bridge.last->confidence);
}

}  // namespace

void bridge_gaps(CameraPath& path) {
    std::vector<PathFrame>& frames = path.frames;
    path.bridged = path.missing = 0;
    std::size_t f = 0;
    while (f < frames.size()) {
        if (measured(frames[f])) {
            ++f;
            continue;
        }
        std::size_t end = f;
        while (end < frames.size() && !measured(frames[end])) ++end;
        const std::size_t length = end - f;
        const bool enclosed = f > 0 && end < frames.size();
        if (enclosed && length <= longest_bridge_frames &&
            frames[end].time_s - frames[f - 1].time_s <= longest_bridge_s + 1e-9) {
            const Bridge bridge{f >= 2 && measured(frames[f - 2]) ? &frames[f - 2] : nullptr, &frames[f - 1],
                                &frames[end],
                                end + 1 < frames.size() && measured(frames[end + 1]) ? &frames[end + 1] : nullptr};
            for (std::size_t i = f; i < end; ++i) fill(bridge, frames[i]);
            path.bridged += static_cast<std::int64_t>(length);
        } else {
            path.missing += static_cast<std::int64_t>(length);
        }
        f = end;
    }
}

}  // namespace matchlight
