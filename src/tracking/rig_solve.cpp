// Relative poses by voting, a spanning tree, and bundle adjustment.
#include "tracking/rig_solve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "tracking/branch_choice.h"

namespace matchlight {

namespace {

using PoseBlock = std::array<double, 6>;  // angle-axis, translation

PoseBlock block_from(const RigidTransform& transform) {
    const Eigen::AngleAxisd turn(transform.linear());
    const Eigen::Vector3d vector = turn.angle() * turn.axis();
    const Eigen::Vector3d t = transform.translation();
    return {vector.x(), vector.y(), vector.z(), t.x(), t.y(), t.z()};
}

RigidTransform transform_from(const PoseBlock& block) {
    const Eigen::Vector3d vector(block[0], block[1], block[2]);
    RigidTransform transform = RigidTransform::Identity();
    if (vector.norm() > 0)
        transform.linear() = Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
    transform.translation() = Eigen::Vector3d(block[3], block[4], block[5]);
    return transform;
}

const RigTag* find_tag(const std::vector<RigTag>& rig, int id) {
    const auto found = std::ranges::find(rig, id, &RigTag::id);
    return found == rig.end() ? nullptr : &*found;
}

/// Observations whose id is in the rig and was seen once in the frame.
std::vector<const TagObservation*> unique_tags(const FrameObservations& frame, const std::vector<RigTag>& rig) {
    std::vector<const TagObservation*> result;
    for (const TagObservation& tag : frame.tags) {
        if (std::ranges::count(frame.tags, tag.id, &TagObservation::id) == 1 && find_tag(rig, tag.id)) {
            result.push_back(&tag);
        }
    }
    return result;
}

/// Up to `most` of `items`, evenly spread.
template <class Item>
std::vector<Item> spread(const std::vector<Item>& items, std::size_t most) {
    if (items.size() <= most) return items;
    std::vector<Item> result;
    for (std::size_t i = 0; i < most; ++i) result.push_back(items[i * items.size() / most]);
    return result;
}

/// What one frame says of a pair of tags: up to four relative poses, because each tag may be seen in two ways.
struct PairView {
    std::vector<std::pair<RigidTransform, double>> first_from_second;  // with its prior weight, 0..1
};

struct PairEstimate {
    RigidTransform first_from_second = RigidTransform::Identity();
    double support = 0;  // in frames
};

/// How well two relative poses agree, 1 = the same. Poses of small tags scatter by degrees and by a part of their size.
double agreement(const RigidTransform& a, const RigidTransform& b, double size_m) {
    constexpr double spread_rad = 0.1;
    const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() / spread_rad;
    const double distance = (a.translation() - b.translation()).norm() / (0.5 * size_m);
    return std::exp(-0.5 * (angle * angle + distance * distance));
}

PairEstimate vote(const std::vector<PairView>& views, double size_m) {
    PairEstimate best;
    for (const PairView& proposer : views) {
        for (const auto& [proposal, prior] : proposer.first_from_second) {
            double support = 0;
            for (const PairView& voter : views) {
                double strongest = 0;
                for (const auto& [candidate, weight] : voter.first_from_second) {
                    strongest = std::max(strongest, weight * agreement(proposal, candidate, size_m));
                }
                support += strongest;
            }
            support *= prior;
            if (support > best.support) best = {proposal, support};
        }
    }
    return best;
}

using Pair = std::pair<int, int>;

std::map<Pair, PairEstimate> relative_poses(const std::vector<RigTag>& rig,
                                            const std::vector<const FrameObservations*>& frames) {
    std::map<Pair, std::vector<PairView>> views;
    for (const FrameObservations* frame : frames) {
        const std::vector<const TagObservation*> tags = unique_tags(*frame, rig);
        std::vector<std::vector<CameraPose>> poses;
        for (const TagObservation* tag : tags) poses.push_back(planar_poses(*tag, find_tag(rig, tag->id)->size_m));
        for (std::size_t i = 0; i < tags.size(); ++i) {
            for (std::size_t j = 0; j < tags.size(); ++j) {
                if (tags[i]->id >= tags[j]->id || poses[i].empty() || poses[j].empty()) continue;
                PairView view;
                for (const CameraPose& a : poses[i]) {
                    for (const CameraPose& b : poses[j]) {
                        // A branch that fits worse is less likely, but never ruled out by one frame.
                        const double excess = a.cost - poses[i].front().cost + b.cost - poses[j].front().cost;
                        const double weight = std::max(0.2, std::exp(-0.1 * excess));
                        view.first_from_second.emplace_back(a.camera_from_world.inverse() * b.camera_from_world,
                                                            weight);
                    }
                }
                views[{tags[i]->id, tags[j]->id}].push_back(std::move(view));
            }
        }
    }
    std::map<Pair, PairEstimate> estimates;
    for (const auto& [pair, list] : views) {
        constexpr std::size_t most_voters = 60;
        const double size_m = std::max(find_tag(rig, pair.first)->size_m, find_tag(rig, pair.second)->size_m);
        estimates[pair] = vote(spread(list, most_voters), size_m);
        estimates[pair].support *=
            static_cast<double>(list.size()) / static_cast<double>(std::min(list.size(), most_voters));
    }
    return estimates;
}

/// Grows the set of placed tags by the best-supported pair each time (Prim's maximum spanning tree).
void place_by_tree(const std::map<Pair, PairEstimate>& estimates, std::map<int, RigidTransform>& world_from_tag) {
    while (true) {
        const PairEstimate* best = nullptr;
        Pair best_pair;
        for (const auto& [pair, estimate] : estimates) {
            if (world_from_tag.contains(pair.first) == world_from_tag.contains(pair.second)) continue;
            if (!best || estimate.support > best->support) best = &estimate, best_pair = pair;
        }
        if (!best || best->support <= 0) return;
        if (world_from_tag.contains(best_pair.first)) {
            world_from_tag[best_pair.second] = world_from_tag[best_pair.first] * best->first_from_second;
        } else {
            world_from_tag[best_pair.first] = world_from_tag[best_pair.second] * best->first_from_second.inverse();
        }
    }
}

/// Whitened reprojection residual of one tag in one frame, in normalised coordinates.
struct TagResidual {
    Eigen::Matrix<double, 3, 4> corners_tag;
    TagCorners measured;
    TagCovariance whitening;

    template <class T>
    bool operator()(const T* camera_from_world, const T* world_from_tag, T* residual) const {
        Eigen::Matrix<T, 8, 1> difference;
        for (int i = 0; i < 4; ++i) {
            const T tag[3] = {T(corners_tag(0, i)), T(corners_tag(1, i)), T(corners_tag(2, i))};
            T world[3], camera[3];
            ceres::AngleAxisRotatePoint(world_from_tag, tag, world);
            for (int k = 0; k < 3; ++k) world[k] += world_from_tag[3 + k];
            ceres::AngleAxisRotatePoint(camera_from_world, world, camera);
            for (int k = 0; k < 3; ++k) camera[k] += camera_from_world[3 + k];
            if (camera[2] < T(1e-6)) return false;
            difference[2 * i] = camera[0] / camera[2] - T(measured(0, i));
            difference[2 * i + 1] = camera[1] / camera[2] - T(measured(1, i));
        }
        Eigen::Map<Eigen::Matrix<T, 8, 1>> whitened(residual);
        whitened = whitening.cast<T>() * difference;
        return true;
    }
};

/// Frames that tie tags together: some of every pair that is ever seen together. Poses and places are determined many
/// times over by a few hundred frames; more cost time and change little.
std::vector<const FrameObservations*> tying_frames(const std::vector<RigTag>& rig,
                                                   const std::vector<FrameObservations>& frames) {
    std::map<Pair, std::vector<const FrameObservations*>> by_pair;
    for (const FrameObservations& frame : frames) {
        const std::vector<const TagObservation*> tags = unique_tags(frame, rig);
        for (std::size_t i = 0; i < tags.size(); ++i) {
            for (std::size_t j = i + 1; j < tags.size(); ++j) by_pair[{tags[i]->id, tags[j]->id}].push_back(&frame);
        }
    }
    constexpr std::size_t most_frames = 300, fewest_per_pair = 8;
    std::map<std::int64_t, const FrameObservations*> chosen;
    for (const auto& [pair, list] : by_pair) {
        for (const FrameObservations* frame : spread(list, std::max(fewest_per_pair, most_frames / by_pair.size()))) {
            chosen[frame->frame] = frame;
        }
    }
    std::vector<const FrameObservations*> result;
    for (const auto& [number, frame] : chosen) result.push_back(frame);
    return result;
}

/// Poses of `frames` for the places found so far, the branch chosen over the clip.
std::vector<std::optional<RigidTransform>> poses_of(const std::vector<RigTag>& rig,
                                                    const std::vector<const FrameObservations*>& frames,
                                                    const std::map<int, RigidTransform>& world_from_tag) {
    Eigen::Vector3d target = Eigen::Vector3d::Zero();
    for (const auto& [id, place] : world_from_tag) target += place.translation() / double(world_from_tag.size());
    std::vector<PoseCandidates> candidates;
    for (const FrameObservations* frame : frames) {
        std::vector<PlacedObservation> placed;
        for (const TagObservation* tag : unique_tags(*frame, rig)) {
            const auto place = world_from_tag.find(tag->id);
            if (place != world_from_tag.end()) placed.push_back({tag, find_tag(rig, tag->id)->size_m, place->second});
        }
        candidates.push_back({frame->time_s, candidate_poses(placed)});
    }
    const auto chosen = choose_branches(candidates, target);
    std::vector<std::optional<RigidTransform>> poses(frames.size());
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (chosen[f]) poses[f] = candidates[f].poses[*chosen[f]].camera_from_world;
    }
    return poses;
}

double adjust(const std::vector<RigTag>& rig, const std::vector<const FrameObservations*>& frames,
              const std::set<int>& held, std::map<int, RigidTransform>& world_from_tag) {
    const std::vector<std::optional<RigidTransform>> poses = poses_of(rig, frames, world_from_tag);
    std::vector<PoseBlock> cameras(frames.size());
    std::map<int, PoseBlock> places;
    for (const auto& [id, place] : world_from_tag) places[id] = block_from(place);
    ceres::Problem problem;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (!poses[f]) continue;
        cameras[f] = block_from(*poses[f]);
        for (const TagObservation* tag : unique_tags(*frames[f], rig)) {
            const auto place = places.find(tag->id);
            if (place == places.end()) continue;
            auto* residual = new TagResidual{tag_corners_m(find_tag(rig, tag->id)->size_m), tag->corners_normalized,
                                             whitening(*tag)};
            // As in camera_pose.cpp: a tag that disagrees grossly must not bend the rig.
            constexpr double loss_scale = 5.7;
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<TagResidual, 8, 6, 6>(residual),
                                     new ceres::CauchyLoss(loss_scale), cameras[f].data(), place->second.data());
            if (held.contains(tag->id)) problem.SetParameterBlockConstant(place->second.data());
        }
    }
    if (problem.NumResidualBlocks() == 0) return 0;
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-10;
    options.num_threads = 1;  // sums in a fixed order: the result does not depend on the machine's cores
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return 0;
    for (const auto& [id, block] : places) {
        if (!held.contains(id)) world_from_tag[id] = transform_from(block);
    }
    return std::sqrt(2 * summary.final_cost / std::max(1, problem.NumResiduals()));
}

}  // namespace

RigSolution solve_rig(const std::vector<RigTag>& rig, const std::vector<FrameObservations>& frames) {
    RigSolution solution;
    std::set<int> held, seen;
    for (const RigTag& tag : rig) {
        if (!tag.world_from_tag) continue;
        solution.world_from_tag[tag.id] = *tag.world_from_tag;
        held.insert(tag.id);
    }
    for (const FrameObservations& frame : frames) {
        for (const TagObservation* tag : unique_tags(frame, rig)) seen.insert(tag->id);
    }
    if (held.empty() && !seen.empty()) {
        solution.world_from_tag[*seen.begin()] = RigidTransform::Identity();
        held.insert(*seen.begin());
        solution.origin = *seen.begin();
    }
    const bool all_placed = std::ranges::all_of(seen, [&](int id) { return solution.world_from_tag.contains(id); });
    if (all_placed) return solution;

    const std::vector<const FrameObservations*> useful = tying_frames(rig, frames);
    place_by_tree(relative_poses(rig, useful), solution.world_from_tag);
    for (const int id : seen) {
        if (!solution.world_from_tag.contains(id)) solution.unplaced.push_back(id);
    }
    // The second round starts from poses whose branches were chosen with the first round's better places.
    for (int round = 0; round < 2; ++round) solution.rms = adjust(rig, useful, held, solution.world_from_tag);
    return solution;
}

}  // namespace matchlight
