// Normal equations of what the frames of a clip share: what the frames say, and what is known beforehand.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "tracking/bundle.h"

namespace matchlight {

/// cost(δ) = const + gradientᵀδ + ½ δᵀ·information·δ about the model.
struct SharedNormal {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;

    explicit SharedNormal(int count = 0)
        : information(Eigen::MatrixXd::Zero(count, count)), gradient(Eigen::VectorXd::Zero(count)) {}
    SharedNormal& operator+=(const SharedNormal& other);

    /// Adds ½|residual + jacobian·δ|², the jacobian's columns at `columns` (negative ones are held).
    void add_squares(const Eigen::VectorXd& residual, const Eigen::MatrixXd& jacobian, const std::vector<int>& columns);
};

/// What a run of frames says, their poses eliminated (Schur complement).
SharedNormal normal_of_frames(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns,
                              std::span<const BundleFrame> frames);

/// Calibrated lens.
SharedNormal lens_prior_normal(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns);
/// Corner offsets of standard deviation `sigma_px` at each tag's median distance.
SharedNormal offset_prior_normal(const ClipModel& model, const SharedColumns& columns, double sigma_px);

/// How a tag's sheet lies to the common plane: middle, and at half its size to the right and to the top (metres), with
/// the derivatives by the columns.
struct PlaneDeparture {
    Eigen::Vector3d heights_m;
    Eigen::Matrix<double, 3, 9> jacobian;
    std::vector<int> columns;  // nine, −1 where held
};
PlaneDeparture plane_departure(const ClipModel& model, const SharedColumns& columns, int id);

/// All that `freedom` takes as known.
SharedNormal prior_normal(const ClipModel& model, const ModelFreedom& freedom, const SharedColumns& columns);

}  // namespace matchlight
