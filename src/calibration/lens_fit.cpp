// The adjustment itself: Ceres, poses eliminated first.
//
// Zhang, "A Flexible New Technique for Camera Calibration" (2000); the bent board follows the idea of mrcal's board
// deflection (Kogan, 2021): two paraboloids, and here a twist.
#include "calibration/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <glog/logging.h>
#include <opencv2/calib3d.hpp>

#include "core/error.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int first_coefficient = 4;

/// A corner of the board with the two numbers (−1 to 1) by which it bends.
struct BoardPoint {
    double x, y, u, v;
};

std::vector<BoardPoint> board_points(const BoardSpec& board) {
    const std::vector<Vector3d> corners = board_corners_m(board);
    Vector3d low = corners.front(), high = corners.front();
    for (const Vector3d& corner : corners) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
    }
    const Vector3d middle = (low + high) / 2;
    const double half_x = std::max(1e-12, (high.x() - low.x()) / 2);
    const double half_y = std::max(1e-12, (high.y() - low.y()) / 2);
    std::vector<BoardPoint> points;
    for (const Vector3d& corner : corners) {
        points.push_back(
            {corner.x(), corner.y(), (corner.x() - middle.x()) / half_x, (corner.y() - middle.y()) / half_y});
    }
    return points;
}

struct CornerResidual {
    LensModel lens;
    BoardPoint point;
    Vector2d px;

    template <class T>
    bool operator()(const T* lens_values, const T* bend, const T* pose, T* residual) const {
        const T board[3] = {
            T(point.x), T(point.y),
            bend[0] * (1 - point.u * point.u) + bend[1] * (1 - point.v * point.v) + bend[2] * (point.u * point.v)};
        T camera[3];
        ceres::AngleAxisRotatePoint(pose, board, camera);
        for (int i = 0; i < 3; ++i) camera[i] += pose[3 + i];
        T projected[2];
        if (!project(lens, lens_values, camera, projected)) return false;
        residual[0] = px.x() - projected[0];
        residual[1] = px.y() - projected[1];
        return true;
    }
};

ceres::CostFunction* corner_cost(const LensFit& fit, const BoardPoint& point, const Vector2d& px) {
    return new ceres::AutoDiffCostFunction<CornerResidual, 2, lens_parameters, 3, 6>(
        new CornerResidual{fit.candidate.lens, point, px});
}

std::vector<int> constant_parameters(const LensCandidate& candidate) {
    std::vector<int> constant;
    for (int i = 0; i < lens_parameters; ++i) {
        if (!candidate.estimates(i)) constant.push_back(i);
    }
    return constant;
}

ceres::Solver::Options solver_options(int steps) {
    // A trial that leads nowhere is part of a search; glog would print each on standard error.
    FLAGS_minloglevel = google::GLOG_FATAL;
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = steps;
    options.function_tolerance = 1e-12;
    options.gradient_tolerance = 1e-12;
    options.parameter_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;  // sums keep their order; folds and candidates run side by side instead
    return options;
}

/// Two of the steps of a start: only the focal length and the first coefficient are free, or what the candidate has.
enum class Freedom { focal_only, candidate };

double solve(const LensData& data, LensFit& fit, const AdjustOptions& options, Freedom freedom, int steps) {
    const std::vector<BoardPoint> points = board_points(data.board);
    ceres::Problem::Options problem_options;
    ceres::Problem problem(problem_options);
    const auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    double* lens = fit.lens.data();
    double* bend = fit.bend_m.data();
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        if (!options.in_use.empty() && options.in_use[v] == 0) continue;
        double* pose = fit.poses[v].data();
        for (const BoardCorner& corner : data.views[v].corners) {
            problem.AddResidualBlock(corner_cost(fit, points[static_cast<std::size_t>(corner.index)], corner.px),
                                     options.robust_px > 0 ? new ceres::CauchyLoss(options.robust_px) : nullptr, lens,
                                     bend, pose);
        }
        if (problem.HasParameterBlock(pose)) ordering->AddElementToGroup(pose, 0);
    }
    if (!problem.HasParameterBlock(lens)) return std::numeric_limits<double>::infinity();
    ordering->AddElementToGroup(lens, 1);
    ordering->AddElementToGroup(bend, 1);
    std::vector<int> constant = constant_parameters(fit.candidate);
    if (freedom == Freedom::focal_only) {
        constant = {2, 3};
        for (int i = first_coefficient + 1; i < lens_parameters; ++i) constant.push_back(i);
    }
    if (!constant.empty()) problem.SetManifold(lens, new ceres::SubsetManifold(lens_parameters, constant));
    if (!fit.candidate.bent_board || freedom == Freedom::focal_only) problem.SetParameterBlockConstant(bend);
    ceres::Solver::Options solver = solver_options(steps);
    solver.linear_solver_ordering = ordering;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    fit.converged = summary.termination_type == ceres::CONVERGENCE;
    return summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
}

void count_rms(const LensData& data, LensFit& fit, const std::vector<char>& in_use) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        if (!in_use.empty() && in_use[v] == 0) continue;
        for (const Vector2d& residual : residuals_of(data, fit, v)) {
            sum += residual.squaredNorm();
            ++count;
        }
    }
    fit.rms_px = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

/// The board's pose from rays: seen by a camera that is turned to the board, so that no ray is far off its axis; then
/// the better of the two poses a plane has (Collins & Bartoli, "Infinitesimal Plane-Based Pose Estimation", 2014).
bool start_pose(const Camera& camera, const std::vector<BoardPoint>& points, const LensView& view, BoardPose& pose) {
    std::vector<Vector3d> rays;
    std::vector<cv::Point3d> board;
    Vector3d mean = Vector3d::Zero();
    for (const BoardCorner& corner : view.corners) {
        const Vector2d n = camera.normalized_from_pixel(corner.px);
        if (!n.allFinite()) continue;
        rays.push_back(n.homogeneous().normalized());
        mean += rays.back();
        const BoardPoint& point = points[static_cast<std::size_t>(corner.index)];
        board.emplace_back(point.x, point.y, 0);
    }
    constexpr std::size_t least = 4;
    if (rays.size() < least || 2 * rays.size() < view.corners.size()) return false;
    const Eigen::Quaterniond turned_from_camera = Eigen::Quaterniond::FromTwoVectors(mean, Vector3d::UnitZ());
    std::vector<cv::Point2d> seen;
    for (const Vector3d& ray : rays) {
        const Vector3d r = turned_from_camera * ray;
        if (r.z() <= 0) return false;
        seen.emplace_back(r.x() / r.z(), r.y() / r.z());
    }
    cv::Vec3d turn, translation;
    try {
        if (!cv::solvePnP(board, seen, cv::Matx33d::eye(), cv::noArray(), turn, translation, false,
                          cv::SOLVEPNP_IPPE)) {
            return false;
        }
    } catch (const cv::Exception&) {
        return false;  // points on a line
    }
    const Vector3d axis(turn[0], turn[1], turn[2]);
    const Eigen::Quaterniond turned_from_board(axis.norm() > 0 ? Eigen::AngleAxisd(axis.norm(), axis.normalized())
                                                               : Eigen::AngleAxisd::Identity());
    const Eigen::Quaterniond back = turned_from_camera.conjugate();
    const Eigen::AngleAxisd rotation(back * turned_from_board);
    const Vector3d r = rotation.angle() * rotation.axis();
    const Vector3d t = back * Vector3d(translation[0], translation[1], translation[2]);
    pose = {r.x(), r.y(), r.z(), t.x(), t.y(), t.z()};
    return r.allFinite() && t.allFinite() && t.z() > 0;
}

/// Poses of all views by the lens that `fit` has; false where more than half of them have none.
bool start_poses(const LensData& data, LensFit& fit, AdjustOptions& options) {
    const Camera camera = camera_of(fit.candidate, fit.lens, data.width, data.height);
    const std::vector<BoardPoint> points = board_points(data.board);
    fit.poses.assign(data.views.size(), BoardPose{0, 0, 0, 0, 0, 1});
    options.in_use.assign(data.views.size(), 0);
    std::size_t found = 0;
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        if (!start_pose(camera, points, data.views[v], fit.poses[v])) continue;
        options.in_use[v] = 1;
        ++found;
    }
    return 2 * found > data.views.size();
}

/// A few views, spread evenly: enough for a first focal length.
LensData thinned(const LensData& data, std::size_t count) {
    if (data.views.size() <= count) return data;
    LensData few{data.board, data.width, data.height, {}};
    for (std::size_t i = 0; i < count; ++i) few.views.push_back(data.views[i * data.views.size() / count]);
    return few;
}

}  // namespace

std::string LensCandidate::lens_name() const {
    return lens == LensModel::fisheye ? "fisheye" : "radtan" + std::to_string(radial_terms);
}

std::string LensCandidate::name() const {
    return lens_name() + (bent_board ? ", bent board" : "");
}

int LensCandidate::parameter_count() const {
    int count = bent_board ? 3 : 0;
    for (int i = 0; i < lens_parameters; ++i) count += estimates(i) ? 1 : 0;
    return count;
}

bool LensCandidate::estimates(int parameter) const {
    if (parameter < first_coefficient + 4) return true;  // the matrix; k1 k2 p1 p2, or the fisheye's four
    return lens == LensModel::radtan && parameter - (first_coefficient + 4) < radial_terms - 2;
}

Camera camera_of(const LensCandidate& candidate, const LensParameters& lens, int width, int height) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = lens[0];
    camera.fy = lens[1];
    camera.cx = lens[2];
    camera.cy = lens[3];
    camera.lens = candidate.lens;
    std::ptrdiff_t count = 4;
    if (candidate.lens == LensModel::radtan && candidate.radial_terms > 2) count = candidate.radial_terms == 3 ? 5 : 8;
    camera.distortion.assign(lens.begin() + first_coefficient, lens.begin() + first_coefficient + count);
    return camera;
}

std::vector<Vector2d> residuals_of(const LensData& data, const LensFit& fit, std::size_t view) {
    static const double nowhere = std::numeric_limits<double>::infinity();
    const std::vector<BoardPoint> points = board_points(data.board);
    std::vector<Vector2d> residuals;
    for (const BoardCorner& corner : data.views[view].corners) {
        const CornerResidual cost{fit.candidate.lens, points[static_cast<std::size_t>(corner.index)], corner.px};
        Vector2d residual;
        if (!cost(fit.lens.data(), fit.bend_m.data(), fit.poses[view].data(), residual.data())) {
            residual.setConstant(nowhere);
        }
        residuals.push_back(residual);
    }
    return residuals;
}

LensStart start_fit(const LensData& data, const LensCandidate& candidate) {
    constexpr std::size_t enough_views = 12;
    const LensData few = thinned(data, enough_views);
    const double longer_side = std::max(data.width, data.height);
    LensFit best;
    double least = std::numeric_limits<double>::infinity();
    // From fisheye lenses to long ones; Newton's basin is a factor of about two wide.
    for (const double relative : {0.3, 0.45, 0.65, 0.9, 1.3, 1.9, 2.8, 4.5}) {
        LensFit fit;
        fit.candidate = candidate;
        fit.lens = {relative * longer_side, relative * longer_side, (data.width - 1) / 2.0, (data.height - 1) / 2.0};
        AdjustOptions options;
        if (!start_poses(few, fit, options)) continue;
        options.robust_px = longer_side / 300;  // two pixels of VGA: the model is still too stiff for less
        constexpr int steps = 25;
        const double cost = solve(few, fit, options, Freedom::focal_only, steps);
        if (cost < least && fit.lens[0] > 0 && fit.lens[1] > 0) {
            least = cost;
            best = fit;
        }
    }
    if (!std::isfinite(least)) {
        throw InputError({}, "no focal length explains the corners of the board in these pictures",
                         "check that --board is the board in the pictures");
    }
    AdjustOptions options;
    start_poses(data, best, options);
    options.robust_px = longer_side / 300;
    adjust(data, best, options);
    options.robust_px = longer_side / 1000;
    adjust(data, best, options);
    // With the better lens, views may be placed that could not be before.
    const LensFit adjusted = best;
    const std::vector<char> posed = options.in_use;
    start_poses(data, best, options);
    for (std::size_t v = 0; v < posed.size(); ++v) {
        if (posed[v] != 0) best.poses[v] = adjusted.poses[v];
        options.in_use[v] = posed[v] != 0 || options.in_use[v] != 0 ? 1 : 0;
    }
    adjust(data, best, options);
    return {best, options.in_use};
}

void adjust(const LensData& data, LensFit& fit, const AdjustOptions& options) {
    constexpr int steps = 60;
    solve(data, fit, options, Freedom::candidate, steps);
    count_rms(data, fit, options.in_use);
}

void adjust_pose(const LensData& data, LensFit& fit, std::size_t view) {
    const std::vector<BoardPoint> points = board_points(data.board);
    ceres::Problem problem;
    for (const BoardCorner& corner : data.views[view].corners) {
        problem.AddResidualBlock(corner_cost(fit, points[static_cast<std::size_t>(corner.index)], corner.px), nullptr,
                                 fit.lens.data(), fit.bend_m.data(), fit.poses[view].data());
    }
    if (!problem.HasParameterBlock(fit.lens.data())) return;
    problem.SetParameterBlockConstant(fit.lens.data());
    problem.SetParameterBlockConstant(fit.bend_m.data());
    constexpr int steps = 30;
    ceres::Solver::Options options = solver_options(steps);
    options.linear_solver_type = ceres::DENSE_QR;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
}

LensFit started_from(const LensFit& fit, const LensCandidate& candidate) {
    LensFit started = fit;
    started.candidate = candidate;
    for (int i = 0; i < lens_parameters; ++i) {
        if (!candidate.estimates(i)) started.lens[static_cast<std::size_t>(i)] = 0;
    }
    if (!candidate.bent_board) started.bend_m = {};
    return started;
}

Eigen::MatrixXd shared_information(const LensData& data, const LensFit& fit) {
    const std::vector<BoardPoint> points = board_points(data.board);
    std::vector<int> lens_columns;
    for (int i = 0; i < lens_parameters; ++i) {
        if (fit.candidate.estimates(i)) lens_columns.push_back(i);
    }
    const auto from_lens = static_cast<Eigen::Index>(lens_columns.size());
    const Eigen::Index shared = from_lens + (fit.candidate.bent_board ? 3 : 0);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(shared, shared);
    Eigen::Matrix<double, 2, lens_parameters, Eigen::RowMajor> by_lens;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_bend;
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_pose;
    double* jacobians[3] = {by_lens.data(), by_bend.data(), by_pose.data()};
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        const double* blocks[3] = {fit.lens.data(), fit.bend_m.data(), fit.poses[v].data()};
        Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(shared, 6);
        Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
        for (const BoardCorner& corner : data.views[v].corners) {
            const std::unique_ptr<ceres::CostFunction> cost(
                corner_cost(fit, points[static_cast<std::size_t>(corner.index)], corner.px));
            Vector2d residual;
            if (!cost->Evaluate(blocks, residual.data(), jacobians)) continue;
            Eigen::MatrixXd by_shared(2, shared);
            for (Eigen::Index i = 0; i < from_lens; ++i) {
                by_shared.col(i) = by_lens.col(lens_columns[static_cast<std::size_t>(i)]);
            }
            if (fit.candidate.bent_board) by_shared.rightCols(3) = by_bend;
            information += by_shared.transpose() * by_shared;
            cross += by_shared.transpose() * by_pose;
            own += by_pose.transpose() * by_pose;
        }
        information -= cross * own.ldlt().solve(cross.transpose());
    }
    return information;
}

}  // namespace matchlight
