// Residuals of tags under poses that they had, or had not, a part in.
#include "report/tag_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/median.h"

namespace matchlight {

namespace {

/// Predicted minus seen, px; nullopt behind the camera.
std::optional<TagCorners> residuals(const PlacedObservation& tag, const RigidTransform& camera_from_world,
                                    const Camera& camera) {
    const Eigen::Matrix<double, 3, 4> points = camera_from_world * (tag.world_from_tag * tag_corners_m(tag.size_m));
    TagCorners off;
    for (int i = 0; i < 4; ++i) {
        if (!(points(2, i) > 1e-6)) return std::nullopt;
        off.col(i) = camera.pixel_from_camera(points.col(i)) - tag.seen->corners_px.col(i);
    }
    return off;
}

struct MeanSquares {
    double sum = 0;
    std::int64_t count = 0;
    void add(double squares, std::int64_t values) { sum += squares, count += values; }
    std::optional<double> root() const {
        return count > 0 ? std::optional(std::sqrt(sum / static_cast<double>(count))) : std::nullopt;
    }
};

}  // namespace

std::vector<PlacedObservation> placed(const FrameObservations& frame, const std::vector<SolvedTag>& rig) {
    std::vector<PlacedObservation> tags;
    for (const SolvedTag& tag : rig) {
        const auto seen = std::ranges::find(frame.tags, tag.id, &TagObservation::id);
        if (seen != frame.tags.end()) tags.push_back({&*seen, tag.size_m, tag.world_from_tag});
    }
    return tags;
}

TagAgreement tag_agreement(const std::vector<FrameObservations>& frames, const std::vector<SolvedFrame>& poses,
                           const std::vector<SolvedTag>& rig, const Camera& camera, const PoseOfTags& pose_of) {
    std::map<std::int64_t, const SolvedFrame*> by_frame;
    for (const SolvedFrame& pose : poses) by_frame[pose.frame] = &pose;
    struct Before {
        std::int64_t frame = 0;
        Eigen::Vector2d off;
    };
    std::map<int, Before> before;
    MeanSquares reprojection, left_out, jitter;
    std::vector<double> each_px;
    for (const FrameObservations& frame : frames) {
        const auto found = by_frame.find(frame.frame);
        if (found == by_frame.end() || !found->second->camera_from_world) continue;
        const RigidTransform& known = *found->second->camera_from_world;
        std::vector<PlacedObservation> tags = placed(frame, rig);
        // Tags that the solve itself holds for moved or hidden have no part in the pose, and none here.
        if (const std::vector<int>& used = found->second->tags; !used.empty()) {
            std::erase_if(tags, [&](const PlacedObservation& tag) { return !std::ranges::count(used, tag.seen->id); });
        }
        for (std::size_t out = 0; out < tags.size(); ++out) {
            if (const auto off = residuals(tags[out], known, camera)) reprojection.add(off->squaredNorm(), 4);
            if (tags.size() < 2) continue;
            std::vector<PlacedObservation> others = tags;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(out));
            const auto pose = pose_of(others, known);
            const auto off = pose ? residuals(tags[out], *pose, camera) : std::nullopt;
            if (!off) continue;
            left_out.add(off->squaredNorm(), 4);
            each_px.push_back(std::sqrt(off->squaredNorm() / 4));
            const Eigen::Vector2d mean = off->rowwise().mean();
            const int id = tags[out].seen->id;
            const auto last = before.find(id);
            if (last != before.end() && last->second.frame + 1 == frame.frame) {
                jitter.add((mean - last->second.off).squaredNorm(), 1);
            }
            before[id] = {frame.frame, mean};
        }
    }
    std::optional<double> median_px;
    if (!each_px.empty()) median_px = upper_median_in_place(each_px);
    return {reprojection.root(), left_out.root(), median_px, jitter.root()};
}

}  // namespace matchlight
