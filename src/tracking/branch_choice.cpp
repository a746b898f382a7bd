// Two-state Viterbi over planar poses, each survivor with a filter of the viewing direction.
#include "tracking/branch_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace matchlight {

namespace {

/// Where the camera stands as seen from the target: a unit vector and its variance (rad², each way).
struct ViewingDirection {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    double variance = 0;
};

ViewingDirection viewing_direction(const CameraPose& pose, const Eigen::Vector3d& target_world_m) {
    const Eigen::Vector3d centre = pose.camera_from_world.inverse().translation();
    const Eigen::Vector3d offset = centre - target_world_m;
    const double distance = std::max(offset.norm(), 1e-9);
    ViewingDirection view;
    view.direction = offset / distance;
    // The centre moves by centre × ω − τ under the perturbation (ω, τ) on the world side.
    Eigen::Matrix<double, 3, 6> by_perturbation;
    by_perturbation << cross_matrix(centre), -Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - view.direction * view.direction.transpose();
    const Eigen::Matrix<double, 3, 6> jacobian = across * by_perturbation / distance;
    view.variance = 0.5 * (jacobian * pose.covariance * jacobian.transpose()).trace();
    return view;
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

/// A hand-held camera moves around its subject by a few degrees in a frame of 1/24 s at most.
constexpr double walk_rad_per_frame = 0.03;
/// What a cut costs: dearer than noise makes a wrong branch look better, and paid once.
constexpr double dearest_change = 40;
/// Beyond this a better fit is no help: a mis-modelled frame must not outvote the clip.
constexpr double most_state_cost = 60;

struct Survivor {
    double cost = 0;
    std::size_t from = 0;
    ViewingDirection expected;
};

Survivor extended(const Survivor& before, const ViewingDirection& seen, double elapsed_s) {
    constexpr double frame_rate = 24;
    const double walk = walk_rad_per_frame * walk_rad_per_frame * std::max(1.0, elapsed_s * frame_rate);
    const double predicted = before.expected.variance + walk;
    const double angle = angle_between(before.expected.direction, seen.direction);
    const double change = 0.5 * angle * angle / (predicted + seen.variance);
    Survivor next;
    if (change >= dearest_change) {  // a new shot
        next.cost = before.cost + dearest_change;
        next.expected = seen;
        return next;
    }
    next.cost = before.cost + change;
    const double gain = predicted / (predicted + seen.variance);
    next.expected.direction =
        (before.expected.direction + gain * (seen.direction - before.expected.direction)).normalized();
    next.expected.variance = (1 - gain) * predicted;
    return next;
}

}  // namespace

std::vector<std::optional<std::size_t>> choose_branches(const std::vector<PoseCandidates>& frames,
                                                        const Eigen::Vector3d& target_world_m) {
    std::vector<std::optional<std::size_t>> chosen(frames.size());
    std::vector<std::size_t> seen;  // frames with candidates
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (!frames[f].poses.empty()) seen.push_back(f);
    }
    if (seen.empty()) return chosen;

    std::vector<std::vector<Survivor>> survivors(seen.size());
    for (std::size_t s = 0; s < seen.size(); ++s) {
        const PoseCandidates& here = frames[seen[s]];
        const double best_cost = std::ranges::min(here.poses, {}, &CameraPose::cost).cost;
        for (const CameraPose& pose : here.poses) {
            const ViewingDirection view = viewing_direction(pose, target_world_m);
            Survivor best;
            best.expected = view;
            if (s > 0) {
                best.cost = std::numeric_limits<double>::infinity();
                const double elapsed_s = here.time_s - frames[seen[s - 1]].time_s;
                for (std::size_t i = 0; i < survivors[s - 1].size(); ++i) {
                    Survivor candidate = extended(survivors[s - 1][i], view, elapsed_s);
                    candidate.from = i;
                    if (candidate.cost < best.cost) best = candidate;
                }
            }
            best.cost += std::min(pose.cost - best_cost, most_state_cost);
            survivors[s].push_back(best);
        }
    }
    const auto last = std::ranges::min_element(survivors.back(), {}, &Survivor::cost);
    std::size_t state = static_cast<std::size_t>(last - survivors.back().begin());
    for (std::size_t s = seen.size(); s-- > 0;) {
        chosen[seen[s]] = state;
        state = survivors[s][state].from;
    }
    return chosen;
}

}  // namespace matchlight
