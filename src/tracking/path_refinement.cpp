// Frame by frame, then over time.
#include "tracking/path_refinement.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "tracking/path_model.h"

namespace matchlight {

namespace {

std::vector<PlacedObservation> placed(const ClipModel& model, const std::vector<BundleView>& views) {
    std::vector<PlacedObservation> tags;
    for (const BundleView& view : views) {
        const ModelTag& tag = model.tags.at(view.seen->id);
        tags.push_back({view.seen, tag.size_m, tag.world_from_tag});
    }
    return tags;
}

/// A frame whose tags disagree by more than their spread allows (one in a thousand by chance) knows its pose as much
/// less well.
double disagreement(const FrameNormal& normal) {
    const double spare = normal.effective_count - 6;
    if (!(spare > 1)) return 1;
    const bool unlikely = normal.squares > spare + 3.1 * std::sqrt(2 * spare);
    return unlikely ? normal.squares / spare : 1;
}

class PathRefinement {
public:
    PathRefinement(const SolvedModel& solved, std::vector<BundleFrame>& frames, CameraPath& path)
        : solved_(solved),
          frames_(frames),
          path_(path),
          measurements_(frames.size()),
          shared_(frames.size(), PoseCovariance::Zero()) {
        for (const auto& [id, tag] : solved.model.tags) {
            target_ += tag.world_from_tag.translation() / static_cast<double>(solved.model.tags.size());
        }
    }

    void run() {
        parallel_for(static_cast<int>(frames_.size()), [&](int f) { measure(static_cast<std::size_t>(f)); });
        const SmoothPath smooth = smooth_path(measurements_);
        for (std::size_t f = 0; f < frames_.size(); ++f) {
            if (!measurements_[f].camera_from_world) continue;
            CameraPose pose = *path_.frames[f].pose;
            pose.camera_from_world = smooth.poses[f]->camera_from_world;
            pose.covariance = smooth.poses[f]->covariance + shared_[f];
            frames_[f].camera_from_world = pose.camera_from_world;
            describe_frame(path_.frames[f], placed(solved_.model, frames_[f].views), pose, solved_.model.camera);
        }
        bridge(smooth);
    }

private:
    void measure(std::size_t f) {
        PathMeasurement& measurement = measurements_[f];
        measurement.time_s = path_.frames[f].time_s;
        BundleFrame& frame = frames_[f];
        if (frame.views.empty()) return;
        const FrameNormal normal = refine_frame(solved_.model, solved_.freedom, solved_.columns, frame);
        if (!normal.in_front) return;
        const PoseCovariance alone = normal.pose_covariance();
        if (!alone.allFinite()) return;
        const auto following = normal.following(alone);
        shared_[f] = following * solved_.covariance(normal.columns, normal.columns) * following.transpose();
        measurement.camera_from_world = frame.camera_from_world;
        measurement.covariance = alone * disagreement(normal);
    }

    /// Gaps of a few frames. A guess that is off by more than a few pixels, or than the camera moves in half a frame,
    /// swims: better no object than that.
    void bridge(const SmoothPath& smooth) {
        constexpr std::size_t longest_frames = 5;
        constexpr double longest_s = 0.25, tolerable_px = 4;
        path_.bridged = path_.missing = 0;
        std::size_t f = 0;
        while (f < frames_.size()) {
            if (measurements_[f].camera_from_world) {
                ++f;
                continue;
            }
            std::size_t end = f;
            while (end < frames_.size() && !measurements_[end].camera_from_world) ++end;
            const bool enclosed = f > 0 && end < frames_.size();
            const bool is_short = enclosed && end - f <= longest_frames &&
                                  measurements_[end].time_s - measurements_[f - 1].time_s <= longest_s + 1e-9;
            for (std::size_t i = f; i < end; ++i) {
                PathFrame& frame = path_.frames[i];
                frame.pose.reset();
                frame.bridged = false;
                if (!is_short || !smooth.poses[i]) continue;
                CameraPose pose;
                pose.camera_from_world = smooth.poses[i]->camera_from_world;
                pose.covariance = smooth.poses[i]->covariance + shared_[f - 1];
                const double sigma_px = projection_sigma_px(pose, solved_.model.camera, target_);
                if (!(sigma_px <= std::max(tolerable_px, 0.5 * motion_px(smooth, i)))) continue;
                frame.pose = pose;
                frame.bridged = true;
                frame.confidence = 0.5 * std::min(path_.frames[f - 1].confidence, path_.frames[end].confidence) /
                                   (1 + sigma_px * sigma_px);
            }
            for (std::size_t i = f; i < end; ++i) ++(path_.frames[i].pose ? path_.bridged : path_.missing);
            f = end;
        }
    }

    /// How far the rig moves in the picture in a frame.
    double motion_px(const SmoothPath& smooth, std::size_t f) const {
        const Camera& camera = solved_.model.camera;
        return 0.5 * (camera.pixel_from_camera(smooth.poses[f + 1]->camera_from_world * target_) -
                      camera.pixel_from_camera(smooth.poses[f - 1]->camera_from_world * target_))
                         .norm();
    }

    const SolvedModel& solved_;
    std::vector<BundleFrame>& frames_;
    CameraPath& path_;
    std::vector<PathMeasurement> measurements_;
    std::vector<PoseCovariance> shared_;  // what shared unknowns add to a pose's covariance
    Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
};

}  // namespace

void refine_path(const SolvedModel& solved, std::vector<BundleFrame>& frames, CameraPath& path) {
    PathRefinement(solved, frames, path).run();
}

void set_velocities(const CameraPath& path, std::vector<BundleFrame>& frames) {
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (frames[f].views.empty()) continue;
        const bool before = f > 0 && !frames[f - 1].views.empty();
        const bool after = f + 1 < frames.size() && !frames[f + 1].views.empty();
        frames[f].velocity.setZero();
        double elapsed_s = 0;
        if (before) {
            frames[f].velocity -= perturbation_between(frames[f].camera_from_world, frames[f - 1].camera_from_world);
            elapsed_s += path.frames[f].time_s - path.frames[f - 1].time_s;
        }
        if (after) {
            frames[f].velocity += perturbation_between(frames[f].camera_from_world, frames[f + 1].camera_from_world);
            elapsed_s += path.frames[f + 1].time_s - path.frames[f].time_s;
        }
        if (elapsed_s > 0) frames[f].velocity /= elapsed_s;
    }
}

std::vector<double> leave_one_out_px(const ClipModel& model, const ModelFreedom& freedom,
                                     const std::vector<BundleFrame>& frames) {
    std::vector<std::vector<double>> by_frame(frames.size());
    parallel_for(static_cast<int>(frames.size()), [&](int index) {
        const BundleFrame& whole = frames[static_cast<std::size_t>(index)];
        for (std::size_t left_out = 0; whole.views.size() > 1 && left_out < whole.views.size(); ++left_out) {
            BundleFrame others = whole;
            others.views.erase(others.views.begin() + static_cast<std::ptrdiff_t>(left_out));
            if (!refine_frame(model, freedom, SharedColumns(), others).in_front) continue;
            by_frame[static_cast<std::size_t>(index)].push_back(
                reprojection_rms_px(placed(model, {whole.views[left_out]}), others.camera_from_world, model.camera));
        }
    });
    std::vector<double> all;
    for (const std::vector<double>& some : by_frame) all.insert(all.end(), some.begin(), some.end());
    return all;
}

}  // namespace matchlight
