// Poses frame by frame, chosen over time.
#include "tracking/camera_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracking/branch_choice.h"

namespace matchlight {

namespace {

/// Half at 25 px or at 75° of tilt, certain at twice the size or a steeper view.
double tag_confidence(const TagObservation& seen, double cosine) {
    const double size = std::clamp(seen.side_px / 50, 0.0, 1.0);
    const double view = std::clamp(cosine / (2 * std::cos(75 * std::numbers::pi / 180)), 0.0, 1.0);
    const double fit = seen.refined ? std::clamp((seen.correlation - 0.7) / 0.2, 0.0, 1.0) : 0.3;
    return std::min(0.98, size * view * fit);
}

bool is_cut_off(const PlacedObservation& tag, const Camera& camera) {
    const Eigen::Array4d x = tag.seen->corners_px.row(0).transpose(), y = tag.seen->corners_px.row(1).transpose();
    return x.minCoeff() < 0 || y.minCoeff() < 0 || x.maxCoeff() > camera.width - 1 || y.maxCoeff() > camera.height - 1;
}

/// Standard deviation, by the covariance, of where a point one tag's size above the largest tag would be drawn:
/// where objects stand.
double expected_error_px(const std::vector<PlacedObservation>& tags, const CameraPose& pose, const Camera& camera) {
    const auto& largest = *std::ranges::max_element(tags, {}, [](const auto& tag) { return tag.seen->side_px; });
    const Eigen::Vector3d world = largest.world_from_tag * Eigen::Vector3d(0, 0, largest.size_m);
    return projection_sigma_px(pose, camera, world);
}

class PathSolver {
public:
    PathSolver(const std::vector<RigTag>& rig, const std::map<int, RigidTransform>& places, const Camera& camera)
        : camera_(camera) {
        for (const RigTag& tag : rig) {
            const auto place = places.find(tag.id);
            if (place == places.end()) continue;
            placed_[tag.id] = {nullptr, tag.size_m, place->second};
            target_ += place->second.translation();
        }
        if (!placed_.empty()) target_ /= static_cast<double>(placed_.size());
    }

    CameraPath solve(const std::vector<FrameObservations>& frames) {
        CameraPath path;
        std::vector<PoseCandidates> candidates;
        std::vector<std::vector<PlacedObservation>> used;
        for (const FrameObservations& frame : frames) {
            PathFrame& result = path.frames.emplace_back();
            result.frame = frame.frame;
            result.time_s = frame.time_s;
            used.push_back(choose_tags(frame, result.seen_twice));
            candidates.push_back({frame.time_s, candidate_poses(used.back())});
        }
        const auto chosen = choose_branches(candidates, target_);
        for (std::size_t f = 0; f < frames.size(); ++f) {
            if (!chosen[f]) continue;
            CameraPose pose = candidates[f].poses[*chosen[f]];
            path.frames[f].outvoted = drop_outvoted(used[f], pose);
            describe_frame(path.frames[f], used[f], pose, camera_);
            for (const PlacedObservation& tag : used[f]) {
                path.frames[f].tags.push_back(tag.seen->id);
                path.frames[f].sightings.push_back(static_cast<std::size_t>(tag.seen - frames[f].tags.data()));
            }
        }
        return path;
    }

private:
    /// The frame's tags that have a place, each id once.
    std::vector<PlacedObservation> choose_tags(const FrameObservations& frame, bool& seen_twice) {
        std::vector<PlacedObservation> once;
        std::map<int, std::vector<PlacedObservation>> twice;
        for (const TagObservation& seen : frame.tags) {
            const auto place = placed_.find(seen.id);
            if (place == placed_.end()) continue;
            PlacedObservation tag = place->second;
            tag.seen = &seen;
            if (std::ranges::count(frame.tags, seen.id, &TagObservation::id) > 1) {
                twice[seen.id].push_back(tag);
            } else {
                once.push_back(tag);
            }
        }
        seen_twice = !twice.empty();
        const std::vector<CameraPose> poses = twice.empty() ? std::vector<CameraPose>() : candidate_poses(once);
        for (const auto& [id, rivals] : twice) {
            const auto misfit = [&](const PlacedObservation& rival) {
                if (!poses.empty()) return reprojection_rms_px({rival}, poses.front().camera_from_world, camera_);
                const auto before = last_centre_px_.find(rival.seen->id);
                // Alone and new: the clearer print is the tag, the other its reflection or copy.
                if (before == last_centre_px_.end()) return -rival.seen->decision_margin;
                return (centre_px(rival) - before->second).norm();
            };
            once.push_back(*std::ranges::min_element(rivals, {}, misfit));
        }
        std::ranges::sort(once, {}, [](const PlacedObservation& tag) { return tag.seen->id; });
        for (const PlacedObservation& tag : once) last_centre_px_[tag.seen->id] = centre_px(tag);
        return once;
    }

    /// Takes out tags that at least two others, which agree among themselves, contradict by far: moved, or fitted in a
    /// smear of motion. Their weight was small already; now it is none.
    bool drop_outvoted(std::vector<PlacedObservation>& tags, CameraPose& pose) const {
        if (tags.size() < 3) return false;
        std::vector<double> misfits;
        for (const PlacedObservation& tag : tags) {
            misfits.push_back(reprojection_rms_px({tag}, pose.camera_from_world, camera_));
        }
        std::vector<double> sorted = misfits;
        std::ranges::sort(sorted);
        constexpr double least_px = 2, times_the_median = 8;
        const double most = std::max(least_px, times_the_median * sorted[(sorted.size() - 1) / 2]);
        std::vector<PlacedObservation> kept;
        for (std::size_t i = 0; i < tags.size(); ++i) {
            if (misfits[i] <= most) kept.push_back(tags[i]);
        }
        if (kept.size() == tags.size() || kept.size() < 2) return false;
        const std::optional<CameraPose> refined = refine_pose(kept, pose.camera_from_world);
        if (!refined) return false;
        tags = kept;
        pose = *refined;
        return true;
    }

    static Eigen::Vector2d centre_px(const PlacedObservation& tag) { return tag.seen->corners_px.rowwise().mean(); }

    const Camera& camera_;
    std::map<int, PlacedObservation> placed_;  // without an observation yet
    Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
    std::map<int, Eigen::Vector2d> last_centre_px_;
};

}  // namespace

void describe_frame(PathFrame& frame, const std::vector<PlacedObservation>& tags, const CameraPose& pose,
                    const Camera& camera) {
    frame.pose = pose;
    frame.reprojection_px = reprojection_rms_px(tags, pose.camera_from_world, camera);
    double doubt = 1, largest_px = 0, least_tilt = std::numbers::pi;
    bool all_cut = true;
    for (const PlacedObservation& tag : tags) {
        const Eigen::Vector3d centre = pose.camera_from_world * tag.world_from_tag.translation();
        const Eigen::Vector3d normal =
            pose.camera_from_world.linear() * tag.world_from_tag.linear() * Eigen::Vector3d::UnitZ();
        const double cosine = std::clamp(-normal.dot(centre.normalized()), 0.0, 1.0);
        largest_px = std::max(largest_px, tag.seen->side_px);
        least_tilt = std::min(least_tilt, std::acos(cosine));
        all_cut = all_cut && is_cut_off(tag, camera);
        doubt *= 1 - tag_confidence(*tag.seen, cosine);
    }
    constexpr double small_px = 25, grazing_rad = 75 * std::numbers::pi / 180;
    frame.small = largest_px < small_px;
    frame.grazing = least_tilt > grazing_rad;
    frame.cut_off = all_cut;
    const double expected_px = expected_error_px(tags, pose, camera);
    constexpr double disagreeing_px = 2;  // several times what blur and noise leave
    frame.disagreeing = frame.reprojection_px > disagreeing_px;
    frame.confidence =
        (1 - doubt) / (1 + expected_px * expected_px) * (frame.disagreeing ? 0.3 : 1.0) * (frame.cut_off ? 0.5 : 1.0);
}

CameraPath solve_path(const std::vector<RigTag>& rig, const std::map<int, RigidTransform>& world_from_tag,
                      const std::vector<FrameObservations>& frames, const Camera& camera) {
    CameraPath path = PathSolver(rig, world_from_tag, camera).solve(frames);
    bridge_gaps(path);
    return path;
}

}  // namespace matchlight
