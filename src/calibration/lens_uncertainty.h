// What the views say about each parameter, and what its uncertainty does to pixels.
#pragma once

#include <Eigen/Core>

#include "calibration/lens_calibration.h"

namespace matchlight {

/// Covariance of the shared parameters (those the candidate estimates, then the bend) for corners of `sigma_px` a
/// coordinate; infinite on the diagonal where the views determine nothing.
Eigen::MatrixXd shared_covariance(const LensData& data, const LensFit& fit, double sigma_px);

/// Covariance by leaving out groups of views (delete-a-group jackknife; Efron & Tibshirani, "An Introduction to the
/// Bootstrap", 1993, 11): they hold what views have in common, such as a board that bends or corners that err together.
Eigen::MatrixXd jackknife_covariance(const LensFit& fit, const std::vector<LensFit>& fold_fits);

/// By whichever of the two covariances says more, place by place.
PixelUncertainty pixel_uncertainty(const LensData& data, const LensFit& fit, const Eigen::MatrixXd& covariance,
                                   const Eigen::MatrixXd& jackknife);

/// Noise of a corner's coordinate from what the fit leaves over, degrees of freedom counted.
double corner_sigma_px(const LensData& data, const LensFit& fit);

}  // namespace matchlight
