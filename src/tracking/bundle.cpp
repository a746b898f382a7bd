// The bundle as a Ceres problem, and its normal equations frame by frame.
#include "tracking/bundle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "tracking/bundle_residuals.h"

namespace matchlight {

namespace {

// pose, place, corner offsets, lens, read-out
using TagCost = ceres::AutoDiffCostFunction<TagPixelResidual, 8, 6, 6, 8, lens_parameter_count, 1>;
using RowMajor8 = Eigen::Matrix<double, 8, Eigen::Dynamic, Eigen::RowMajor>;

/// As in camera_pose.cpp: a whole tag that disagrees grossly must not carry the others away. Cauchy's ρ(s) =
/// a² log(1 + s/a²), a² four times the expected sum of eight squares.
constexpr double loss_scale_squared = 32;

constexpr double zeros[8] = {};

TagCovariance whitening_px(const BundleView& view, const ModelFreedom& freedom) {
    TagCovariance covariance = freedom.noise_scale * freedom.noise_scale * view.covariance_px;
    covariance.diagonal().array() += freedom.noise_floor_px * freedom.noise_floor_px;
    const TagCovariance information = covariance.ldlt().solve(TagCovariance::Identity());
    return Eigen::LLT<TagCovariance>(0.5 * (information + information.transpose())).matrixU();
}

TagPixelResidual residual_of(const ClipModel& model, const ModelFreedom& freedom, const BundleFrame& frame,
                             const BundleView& view) {
    const ModelTag& tag = model.tags.at(view.seen->id);
    TagPixelResidual residual{.lens = LensProjection(model.camera),
                              .camera_from_world = frame.camera_from_world,
                              .world_from_tag = tag.world_from_tag,
                              .corners_tag_m = tag_corners_m(tag.size_m),
                              .measured_px = view.seen->corners_px,
                              .whitening = whitening_px(view, freedom)};
    residual.velocity = frame.velocity;
    residual.readout_phase =
        (view.seen->corners_px.row(1).transpose().array() / std::max(1, model.camera.height - 1) - 0.5).matrix();
    return residual;
}

using OffsetVector = Eigen::Matrix<double, 8, 1>;

OffsetVector offset_vector(const ModelTag& tag) {
    return Eigen::Map<const OffsetVector>(tag.corner_offsets_m.data());
}

/// The Ceres problem, and the blocks it works on.
class BundleProblem {
public:
    BundleProblem(ClipModel& model, const ModelFreedom& freedom, std::vector<BundleFrame>& frames)
        : model_(model),
          freedom_(freedom),
          frames_(frames),
          columns_(model, freedom),
          poses_(frames.size(), PoseVector::Zero()),
          shared_(6 * model.tags.size() + 8 * model.tags.size() + lens_parameter_count + 1 + 3, 0.0) {
        double* next = shared_.data();
        const auto take = [&](std::size_t size) { return std::exchange(next, next + size); };
        for (const auto& [id, tag] : model.tags) {
            places_[id] = take(6);
            offsets_[id] = take(8);
            std::ranges::copy(offset_vector(tag), offsets_.at(id));
        }
        lens_ = take(lens_parameter_count);
        std::ranges::copy(lens_vector(model.camera), lens_);
        readout_s_ = take(1);
        *readout_s_ = model.readout_s;
        plane_ = take(3);
        add_frames();
        if (problem_.NumResidualBlocks() == 0) return;
        add_shared();
    }

    BundleResult solve() {
        BundleResult result;
        if (problem_.NumResidualBlocks() == 0) return result;
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::SPARSE_SCHUR;
        options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
        for (PoseVector& pose : poses_) {
            if (problem_.HasParameterBlock(pose.data()))
                options.linear_solver_ordering->AddElementToGroup(pose.data(), 0);
        }
        std::vector<double*> blocks;
        problem_.GetParameterBlocks(&blocks);
        for (double* block : blocks) {
            if (!options.linear_solver_ordering->IsMember(block)) {
                options.linear_solver_ordering->AddElementToGroup(block, 1);
            }
        }
        options.max_num_iterations = 50;
        options.function_tolerance = 1e-9;
        options.num_threads = 1;  // sums in a fixed order: the result does not depend on the machine's cores
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem_, &summary);
        result.usable = summary.IsSolutionUsable();
        result.half_cost = summary.final_cost;
        if (result.usable) take_back();
        return result;
    }

private:
    void add_frames() {
        for (std::size_t f = 0; f < frames_.size(); ++f) {
            for (const BundleView& view : frames_[f].views) {
                const int id = view.seen->id;
                problem_.AddResidualBlock(
                    new TagCost(new TagPixelResidual(residual_of(model_, freedom_, frames_[f], view))),
                    new ceres::CauchyLoss(std::sqrt(loss_scale_squared)), poses_[f].data(), places_.at(id),
                    offsets_.at(id), lens_, readout_s_);
            }
        }
    }

    void add_shared() {
        for (const auto& [id, place] : places_) {
            if (!problem_.HasParameterBlock(place)) continue;
            if (!columns_.places.contains(id)) problem_.SetParameterBlockConstant(place);
            if (!columns_.offsets.contains(id)) {
                problem_.SetParameterBlockConstant(offsets_.at(id));
            } else {
                const double sigma_m = freedom_.corner_bias_px * model_.tags.at(id).metres_per_px;
                problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<OffsetPrior, 8, 8>(new OffsetPrior{sigma_m}),
                                          nullptr, offsets_.at(id));
            }
            const ModelTag& tag = model_.tags.at(id);
            if (columns_.plane < 0 || !tag.on_plane) continue;
            problem_.AddResidualBlock(
                new ceres::AutoDiffCostFunction<OnPlaneResidual, 3, 6, 3>(new OnPlaneResidual{
                    tag.world_from_tag, model_.world_from_plane, tag.size_m / 2, *freedom_.plane_sigma_m}),
                nullptr, place, plane_);
        }
        std::vector<int> constant;
        for (int i = 0; i < lens_parameter_count; ++i) {
            if (!freedom_.lens[std::size_t(i)]) constant.push_back(i);
        }
        if (constant.size() == lens_parameter_count) {
            problem_.SetParameterBlockConstant(lens_);
        } else {
            if (!constant.empty()) {
                problem_.SetManifold(lens_, new ceres::SubsetManifold(lens_parameter_count, constant));
            }
            problem_.AddResidualBlock(
                new ceres::AutoDiffCostFunction<LensPriorResidual, lens_parameter_count, lens_parameter_count>(
                    new LensPriorResidual{freedom_.prior}),
                nullptr, lens_);
        }
        if (!freedom_.readout) {
            problem_.SetParameterBlockConstant(readout_s_);
        } else {
            problem_.AddResidualBlock(
                new ceres::AutoDiffCostFunction<ReadoutPrior, 1, 1>(new ReadoutPrior{freedom_.readout_sigma_s}),
                nullptr, readout_s_);
        }
    }

    void take_back() {
        model_.camera = camera_with(model_.camera, Eigen::Map<const LensVector>(lens_, lens_parameter_count));
        model_.readout_s = *readout_s_;
        for (auto& [id, tag] : model_.tags) {
            if (columns_.places.contains(id))
                tag.world_from_tag = perturbed(tag.world_from_tag, Eigen::Map<const PoseVector>(places_.at(id)));
            Eigen::Map<OffsetVector>(tag.corner_offsets_m.data()) = Eigen::Map<const OffsetVector>(offsets_.at(id));
        }
        PoseVector plane = PoseVector::Zero();
        plane << plane_[0], plane_[1], 0, 0, 0, plane_[2];
        model_.world_from_plane = perturbed(model_.world_from_plane, plane);
        for (std::size_t f = 0; f < frames_.size(); ++f) {
            frames_[f].camera_from_world = perturbed(frames_[f].camera_from_world, poses_[f]);
        }
    }

    ClipModel& model_;
    const ModelFreedom& freedom_;
    std::vector<BundleFrame>& frames_;
    SharedColumns columns_;
    // Ceres orders blocks by their addresses: two arrays, so that sums run in the same order every time.
    std::vector<PoseVector> poses_;
    std::vector<double> shared_;
    std::map<int, double*> places_, offsets_;  // in shared_, as what follows
    double* lens_ = nullptr;
    double* readout_s_ = nullptr;
    double* plane_ = nullptr;
    ceres::Problem problem_;
};

}  // namespace

BundleView bundle_view(const TagObservation& seen, const Camera& observed_with) {
    const LensVector lens = lens_vector(observed_with);
    const LensProjection projection(observed_with);
    Eigen::Matrix<double, 8, 8> by_normalized = Eigen::Matrix<double, 8, 8>::Zero();
    for (int i = 0; i < 4; ++i) {
        using Jet = ceres::Jet<double, 2>;
        Jet parameters[lens_parameter_count];
        for (int k = 0; k < lens_parameter_count; ++k) parameters[k] = Jet(lens[k]);
        const Eigen::Matrix<Jet, 2, 1> px =
            projection.pixel(parameters, Jet(seen.corners_normalized(0, i), 0), Jet(seen.corners_normalized(1, i), 1));
        by_normalized.row(2 * i).segment<2>(2 * i) = px[0].v;
        by_normalized.row(2 * i + 1).segment<2>(2 * i) = px[1].v;
    }
    return {&seen, by_normalized * seen.covariance * by_normalized.transpose()};
}

PoseCovariance FrameNormal::pose_covariance() const {
    const PoseCovariance covariance = pose.ldlt().solve(PoseCovariance::Identity());
    return 0.5 * (covariance + covariance.transpose());
}

FrameNormal frame_normal(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns,
                         const BundleFrame& frame) {
    FrameNormal normal;
    // Columns this frame touches, and where each has its place among them.
    std::map<int, int> local;
    const auto touch = [&](int first, int width) {
        for (int i = 0; first >= 0 && i < width; ++i) local.emplace(first + i, 0);
    };
    for (const int column : columns.lens) touch(column, 1);
    touch(columns.readout, 1);
    for (const BundleView& view : frame.views) {
        if (const auto place = columns.places.find(view.seen->id); place != columns.places.end())
            touch(place->second, 6);
        if (const auto offsets = columns.offsets.find(view.seen->id); offsets != columns.offsets.end()) {
            touch(offsets->second, 8);
        }
    }
    for (auto& [column, index] : local) {
        index = static_cast<int>(normal.columns.size());
        normal.columns.push_back(column);
    }
    const auto width = static_cast<Eigen::Index>(local.size());
    normal.cross.setZero(6, width);
    normal.shared.setZero(width, width);
    normal.shared_right.setZero(width);

    const LensVector lens = lens_vector(model.camera);
    for (const BundleView& view : frame.views) {
        const OffsetVector offsets = offset_vector(model.tags.at(view.seen->id));
        const TagCost cost(new TagPixelResidual(residual_of(model, freedom, frame, view)));
        Eigen::Matrix<double, 8, 1> residual;
        Eigen::Matrix<double, 8, 6, Eigen::RowMajor> by_pose, by_place, by_lens;
        Eigen::Matrix<double, 8, 8, Eigen::RowMajor> by_offsets;
        Eigen::Matrix<double, 8, 1> by_readout;
        const double* parameters[] = {zeros, zeros, offsets.data(), lens.data(), &model.readout_s};
        double* jacobians[] = {by_pose.data(), by_place.data(), by_offsets.data(), by_lens.data(), by_readout.data()};
        if (!cost.Evaluate(parameters, residual.data(), jacobians)) {
            normal.in_front = false;
            return normal;
        }
        RowMajor8 by_shared = RowMajor8::Zero(8, width);
        for (int i = 0; i < lens_parameter_count; ++i) {
            const int column = columns.lens[std::size_t(i)];
            if (column >= 0) by_shared.col(local.at(column)) = by_lens.col(i);
        }
        if (columns.readout >= 0) by_shared.col(local.at(columns.readout)) = by_readout;
        if (const auto place = columns.places.find(view.seen->id); place != columns.places.end()) {
            by_shared.middleCols<6>(local.at(place->second)) = by_place;
        }
        if (const auto offset = columns.offsets.find(view.seen->id); offset != columns.offsets.end()) {
            by_shared.middleCols<8>(local.at(offset->second)) = by_offsets;
        }
        const double squares = residual.squaredNorm();
        const double weight = 1 / (1 + squares / loss_scale_squared);
        normal.half_cost += 0.5 * loss_scale_squared * std::log1p(squares / loss_scale_squared);
        normal.squares += weight * squares;
        normal.effective_count += 8 * weight;
        normal.pose += weight * by_pose.transpose() * by_pose;
        normal.pose_right -= weight * by_pose.transpose() * residual;
        normal.cross += weight * by_pose.transpose() * by_shared;
        normal.shared += weight * by_shared.transpose() * by_shared;
        normal.shared_right -= weight * by_shared.transpose() * residual;
    }
    return normal;
}

FrameNormal refine_frame(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns,
                         BundleFrame& frame) {
    ModelFreedom pose_only = freedom;
    pose_only.lens = {};
    const SharedColumns none = [&] {
        SharedColumns empty = columns;
        empty.lens.fill(-1);
        empty.readout = empty.plane = -1;
        empty.places.clear();
        empty.offsets.clear();
        return empty;
    }();
    FrameNormal state = frame_normal(model, freedom, none, frame);
    double damping = 1e-6;
    for (int iteration = 0; state.in_front && iteration < 30; ++iteration) {
        bool lowered = false;
        double gain = 0;
        for (int attempt = 0; attempt < 8; ++attempt) {
            PoseCovariance damped = state.pose;
            damped.diagonal() *= 1 + damping;
            BundleFrame next = frame;
            next.camera_from_world = perturbed(frame.camera_from_world, damped.ldlt().solve(state.pose_right));
            if (next.camera_from_world.matrix().allFinite()) {
                const FrameNormal candidate = frame_normal(model, freedom, none, next);
                if (candidate.in_front && candidate.half_cost < state.half_cost) {
                    gain = state.half_cost - candidate.half_cost;
                    frame.camera_from_world = next.camera_from_world;
                    state = candidate;
                    lowered = true;
                    damping = std::max(damping * 0.1, 1e-12);
                    break;
                }
            }
            damping *= 10;
        }
        if (!lowered || gain < 1e-10 * (1 + state.half_cost)) break;
    }
    return frame_normal(model, freedom, columns, frame);
}

BundleResult adjust_bundle(ClipModel& model, const ModelFreedom& freedom, std::vector<BundleFrame>& frames) {
    return BundleProblem(model, freedom, frames).solve();
}

}  // namespace matchlight
