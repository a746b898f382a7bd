// Covariances of a calibrated lens.
#include "calibration/lens_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <ceres/jet.h>

#include "calibration/lens_projection.h"

namespace matchlight {
namespace {

using Eigen::MatrixXd;

/// The shared parameters of a fit, in the order of their covariance.
Eigen::VectorXd shared_values(const LensFit& fit) {
    Eigen::VectorXd values(fit.candidate.parameter_count());
    Eigen::Index at = 0;
    for (int i = 0; i < lens_parameters; ++i) {
        if (fit.candidate.estimates(i)) values[at++] = fit.lens[static_cast<std::size_t>(i)];
    }
    if (fit.candidate.bent_board) {
        for (const double bend : fit.bend_m) values[at++] = bend;
    }
    return values;
}

}  // namespace

MatrixXd shared_covariance(const LensData& data, const LensFit& fit, double sigma_px) {
    const MatrixXd information = shared_information(data, fit);
    // Scaled to a unit diagonal, so that pixels and coefficients compare.
    const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scaled);
    constexpr double singular = 1e-12;  // of rounding: normal matrices square the Jacobian's condition
    if (!(eigen.eigenvalues().minCoeff() > singular)) {
        return MatrixXd::Identity(scaled.rows(), scaled.cols()) * std::numeric_limits<double>::infinity();
    }
    const MatrixXd inverse =
        eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
    return sigma_px * sigma_px * (scale.asDiagonal() * inverse * scale.asDiagonal());
}

MatrixXd jackknife_covariance(const LensFit& fit, const std::vector<LensFit>& fold_fits) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(fit.candidate.parameter_count());
    const double n = static_cast<double>(fold_fits.size());
    for (const LensFit& without : fold_fits) mean += shared_values(without) / n;
    MatrixXd covariance = MatrixXd::Zero(mean.size(), mean.size());
    for (const LensFit& without : fold_fits) {
        const Eigen::VectorXd apart = shared_values(without) - mean;
        covariance += (n - 1) / n * apart * apart.transpose();
    }
    return covariance;
}

PixelUncertainty pixel_uncertainty(const LensData& data, const LensFit& fit, const MatrixXd& covariance,
                                   const MatrixXd& jackknife) {
    PixelUncertainty pixels;
    pixels.columns = 16;
    pixels.rows = std::max(1, 16 * data.height / data.width);
    const Camera camera = camera_of(fit.candidate, fit.lens, data.width, data.height);
    Eigen::Index lens_count = 0;
    for (int i = 0; i < lens_parameters; ++i) lens_count += fit.candidate.estimates(i) ? 1 : 0;
    const MatrixXd by_noise = covariance.topLeftCorner(lens_count, lens_count);
    const MatrixXd by_views = jackknife.topLeftCorner(lens_count, lens_count);

    std::vector<MatrixXd> by_lens;
    std::vector<Eigen::Matrix<double, 2, 3>> by_turn;
    Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
    MatrixXd turn_by_lens = MatrixXd::Zero(3, lens_count);
    for (int row = 0; row < pixels.rows; ++row) {
        for (int column = 0; column < pixels.columns; ++column) {
            const Eigen::Vector2d px((column + 0.5) * data.width / pixels.columns - 0.5,
                                     (row + 0.5) * data.height / pixels.rows - 0.5);
            const Eigen::Vector2d n = camera.normalized_from_pixel(px);
            by_lens.emplace_back();
            by_turn.emplace_back();
            if (!n.allFinite()) continue;
            using Jet = ceres::Jet<double, lens_parameters + 3>;
            const Eigen::Vector3d ray = n.homogeneous().normalized();
            std::array<Jet, lens_parameters> lens;
            for (int i = 0; i < lens_parameters; ++i) {
                lens[static_cast<std::size_t>(i)] = Jet(fit.lens[static_cast<std::size_t>(i)], i);
            }
            const Jet turn[3] = {Jet(0, lens_parameters), Jet(0, lens_parameters + 1), Jet(0, lens_parameters + 2)};
            const Jet point[3] = {ray.x() + turn[1] * ray.z() - turn[2] * ray.y(),
                                  ray.y() + turn[2] * ray.x() - turn[0] * ray.z(),
                                  ray.z() + turn[0] * ray.y() - turn[1] * ray.x()};
            Jet projected[2];
            if (!project(fit.candidate.lens, lens.data(), point, projected)) continue;
            MatrixXd j(2, lens_count);
            for (int axis = 0; axis < 2; ++axis) {
                Eigen::Index at = 0;
                for (int i = 0; i < lens_parameters; ++i) {
                    if (fit.candidate.estimates(i)) j(axis, at++) = projected[axis].v[i];
                }
                by_turn.back().row(axis) = projected[axis].v.tail<3>().transpose();
            }
            by_lens.back() = j;
            turns += by_turn.back().transpose() * by_turn.back();
            turn_by_lens += by_turn.back().transpose() * j;
        }
    }
    // A lens that shifts all pixels as a turned camera would is as good: that part does no harm and is left out.
    const MatrixXd compensation = turns.ldlt().solve(turn_by_lens);
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < by_lens.size(); ++i) {
        if (by_lens[i].size() == 0) {
            pixels.sigma_px.push_back(std::numeric_limits<double>::quiet_NaN());
            continue;
        }
        const MatrixXd j = by_lens[i] - by_turn[i] * compensation;
        const double variance =
            std::max((j * by_noise * j.transpose()).trace(), (j * by_views * j.transpose()).trace());
        pixels.sigma_px.push_back(std::sqrt(variance));
        pixels.worst_px = std::max(pixels.worst_px, pixels.sigma_px.back());
        sum += variance;
        ++count;
    }
    pixels.rms_px = count > 0 ? std::sqrt(sum / count) : 0;
    return pixels;
}

double corner_sigma_px(const LensData& data, const LensFit& fit) {
    double sum = 0, numbers = 0;
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        for (const Eigen::Vector2d& residual : residuals_of(data, fit, v)) {
            sum += residual.squaredNorm();
            numbers += 2;
        }
    }
    const double unknowns = fit.candidate.parameter_count() + 6.0 * static_cast<double>(data.views.size());
    return std::sqrt(sum / std::max(1.0, numbers - unknowns));
}

}  // namespace matchlight
