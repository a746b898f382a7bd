// Two-state Viterbi over planar poses.
#include "tracking/branch_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace matchlight {

namespace {

Eigen::Vector3d viewing_direction(const CameraPose& pose, const Eigen::Vector3d& target_world_m) {
    return (pose.camera_from_world.inverse().translation() - target_world_m).normalized();
}

/// A hand-held camera moves around its subject by a few degrees in a frame of 1/24 s at most.
double change_cost(double angle_rad, double elapsed_s) {
    constexpr double spread_rad_at_24_hz = 0.05;
    constexpr double dearest = 40;  // a cut: dearer than noise makes a wrong branch look better, dear once
    const double spread = spread_rad_at_24_hz * std::max(1.0, elapsed_s * 24);
    return std::min(0.5 * (angle_rad / spread) * (angle_rad / spread), dearest);
}

/// The branches' costs differ by more than noise can explain when the tag is large; beyond this more is no help, and a
/// mis-modelled frame must not outvote the clip.
constexpr double most_state_cost = 60;

}  // namespace

std::vector<std::optional<std::size_t>> choose_branches(const std::vector<PoseCandidates>& frames,
                                                        const Eigen::Vector3d& target_world_m) {
    std::vector<std::optional<std::size_t>> chosen(frames.size());
    std::vector<std::size_t> seen;  // frames with candidates
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (!frames[f].poses.empty()) seen.push_back(f);
    }
    if (seen.empty()) return chosen;

    std::vector<std::vector<double>> total(seen.size());
    std::vector<std::vector<std::size_t>> came_from(seen.size());
    for (std::size_t s = 0; s < seen.size(); ++s) {
        const PoseCandidates& here = frames[seen[s]];
        const double best = std::ranges::min(here.poses, {}, &CameraPose::cost).cost;
        for (const CameraPose& pose : here.poses) {
            double arrival = 0;
            std::size_t from = 0;
            if (s > 0) {
                const PoseCandidates& before = frames[seen[s - 1]];
                arrival = std::numeric_limits<double>::infinity();
                for (std::size_t i = 0; i < before.poses.size(); ++i) {
                    const double cosine =
                        viewing_direction(pose, target_world_m).dot(viewing_direction(before.poses[i], target_world_m));
                    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
                    const double cost = total[s - 1][i] + change_cost(angle, here.time_s - before.time_s);
                    if (cost < arrival) arrival = cost, from = i;
                }
            }
            total[s].push_back(arrival + std::min(pose.cost - best, most_state_cost));
            came_from[s].push_back(from);
        }
    }
    std::size_t state = static_cast<std::size_t>(std::ranges::min_element(total.back()) - total.back().begin());
    for (std::size_t s = seen.size(); s-- > 0;) {
        chosen[seen[s]] = state;
        state = came_from[s][state];
    }
    return chosen;
}

}  // namespace matchlight
