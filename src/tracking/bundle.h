// Bundle adjustment: poses of all frames and what they share, with covariances that know of one another.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <ceres/ceres.h>

#include "tracking/clip_model.h"
#include "tracking/shared_columns.h"

namespace matchlight {

/// One sighting of a tag, and the spread of its corners in the plate.
struct BundleView {
    const TagObservation* seen = nullptr;
    TagCovariance covariance_px = TagCovariance::Identity();  // as the fit states it
};

struct BundleFrame {
    RigidTransform camera_from_world = RigidTransform::Identity();
    PoseVector velocity = PoseVector::Zero();  // perturbation a second, on the world side
    std::vector<BundleView> views;             // of tags in the model, each once
};

/// A view whose covariance went through the lens that its corners were undone with.
BundleView bundle_view(const TagObservation& seen, const Camera& observed_with);

/// Gauss–Newton's normal equations of one frame about its pose and the model: perturbation ξ of the pose, δ of the
/// shared unknowns in `columns`.
struct FrameNormal {
    PoseCovariance pose = PoseCovariance::Zero();
    PoseVector pose_right = PoseVector::Zero();
    std::vector<int> columns;
    Eigen::Matrix<double, 6, Eigen::Dynamic> cross;
    Eigen::MatrixXd shared;
    Eigen::VectorXd shared_right;
    double half_cost = 0;        // robust
    double squares = 0;          // weighted, of whitened residuals
    double effective_count = 0;  // Σ of the weights, eight residuals a tag
    bool in_front = true;

    PoseCovariance pose_covariance() const;  // with the shared unknowns as they are
    /// dξ/dδ: how the best pose follows the shared unknowns.
    Eigen::Matrix<double, 6, Eigen::Dynamic> following(const PoseCovariance& covariance) const {
        return -covariance * cross;
    }
};

FrameNormal frame_normal(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns,
                         const BundleFrame& frame);

/// Levenberg–Marquardt over the pose alone; the model is held. Returns the normal equations at the end.
FrameNormal refine_frame(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns,
                         BundleFrame& frame);

struct BundleResult {
    double half_cost = 0;  // robust, priors included
    bool usable = false;
};

/// Minimises over the poses of `frames` and all that `freedom` sets free (Ceres; whole-tag Cauchy loss). Model and
/// frames are updated. Deterministic.
BundleResult adjust_bundle(ClipModel& model, const ModelFreedom& freedom, std::vector<BundleFrame>& frames);

}  // namespace matchlight
