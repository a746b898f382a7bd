// Planar and joint pose refinement on normalised corners.
#include "tracking/camera_pose.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace matchlight {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Vector8 = Eigen::Matrix<double, 8, 1>;

struct WhitenedTag {
    Eigen::Matrix<double, 3, 4> corners_world;
    TagCorners measured;
    TagCovariance whitening;
};

/// Cauchy's weight on a whole tag: eight residuals of unit variance are expected to sum to 8; a tag that was moved or
/// misread sums to thousands and must not carry the others away.
struct RobustSquares {
    double half_cost = 0, weight = 1;
};
RobustSquares robust_squares(double squares) {
    constexpr double scale = 32;  // four times the expected sum: consistent tags keep nearly their full weight
    return {0.5 * scale * std::log1p(squares / scale), 1 / (1 + squares / scale)};
}

struct Linearized {
    double cost = 0;
    PoseCovariance normal = PoseCovariance::Zero();
    Vector6 right = Vector6::Zero();
    bool in_front = true;
};

Linearized linearize(const std::vector<WhitenedTag>& tags, const RigidTransform& camera_from_world) {
    Linearized result;
    const Eigen::Matrix3d rotation = camera_from_world.linear();
    for (const WhitenedTag& tag : tags) {
        Vector8 residual;
        Eigen::Matrix<double, 8, 6> jacobian;
        for (int i = 0; i < 4; ++i) {
            const Eigen::Vector3d world = tag.corners_world.col(i);
            const Eigen::Vector3d camera = camera_from_world * world;
            if (!(camera.z() > 1e-6)) {
                result.in_front = false;
                return result;
            }
            const Eigen::Vector2d projected = camera.head<2>() / camera.z();
            residual.segment<2>(2 * i) = tag.measured.col(i) - projected;
            Eigen::Matrix<double, 2, 3> by_camera;
            by_camera << 1 / camera.z(), 0, -projected.x() / camera.z(), 0, 1 / camera.z(), -projected.y() / camera.z();
            Eigen::Matrix<double, 3, 6> camera_by_perturbation;
            camera_by_perturbation << -rotation * cross_matrix(world), rotation;
            jacobian.block<2, 6>(2 * i, 0) = by_camera * camera_by_perturbation;
        }
        const Vector8 whitened = tag.whitening * residual;
        const Eigen::Matrix<double, 8, 6> whitened_jacobian = tag.whitening * jacobian;
        const RobustSquares robust = robust_squares(whitened.squaredNorm());
        result.cost += robust.half_cost;
        result.normal += robust.weight * whitened_jacobian.transpose() * whitened_jacobian;
        result.right += robust.weight * whitened_jacobian.transpose() * whitened;
    }
    return result;
}

std::optional<CameraPose> minimise(const std::vector<WhitenedTag>& tags, const RigidTransform& start) {
    RigidTransform pose = start;
    Linearized state = linearize(tags, pose);
    if (!state.in_front) return std::nullopt;
    double damping = 1e-4;
    for (int iteration = 0; iteration < 60; ++iteration) {
        bool lowered = false;
        double gain = 0;
        for (int attempt = 0; attempt < 8; ++attempt) {
            PoseCovariance damped = state.normal;
            damped.diagonal() += damping * state.normal.diagonal();
            const RigidTransform next_pose = perturbed(pose, damped.ldlt().solve(state.right));
            if (next_pose.matrix().allFinite()) {
                const Linearized next = linearize(tags, next_pose);
                if (next.in_front && next.cost < state.cost) {
                    gain = state.cost - next.cost;
                    pose = next_pose;
                    state = next;
                    lowered = true;
                    damping = std::max(damping * 0.1, 1e-12);
                    break;
                }
            }
            damping *= 10;
        }
        if (!lowered || gain < 1e-10 * (1 + state.cost)) break;
    }
    CameraPose result;
    result.camera_from_world = pose;
    result.cost = state.cost;
    // Residuals larger than their assumed spread widen the covariance; smaller ones do not narrow it.
    double squares = 0;
    for (const WhitenedTag& tag : tags) {
        Vector8 residual;
        for (int i = 0; i < 4; ++i) {
            residual.segment<2>(2 * i) =
                tag.measured.col(i) - (pose * Eigen::Vector3d(tag.corners_world.col(i))).hnormalized();
        }
        const double sum = (tag.whitening * residual).squaredNorm();
        squares += robust_squares(sum).weight * sum;
    }
    const double freedom = 8.0 * static_cast<double>(tags.size()) - 6.0;
    const double spread = std::max(1.0, squares / freedom);
    const PoseCovariance covariance = state.normal.ldlt().solve(PoseCovariance::Identity()) * spread;
    result.covariance = 0.5 * (covariance + covariance.transpose());
    if (!result.covariance.allFinite()) return std::nullopt;
    return result;
}

std::vector<WhitenedTag> whitened(const std::vector<PlacedObservation>& tags) {
    std::vector<WhitenedTag> result;
    for (const PlacedObservation& tag : tags) {
        WhitenedTag item;
        item.corners_world = tag.world_from_tag * tag_corners_m(tag.size_m);
        item.measured = tag.seen->corners_normalized;
        item.whitening = whitening(*tag.seen);
        result.push_back(item);
    }
    return result;
}

/// Two minima are one when a pose lies within half a degree of the other: refinement ended at the same place.
bool same_minimum(const RigidTransform& a, const RigidTransform& b) {
    constexpr double half_a_degree = 0.0087;
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < half_a_degree;
}

}  // namespace

RigidTransform perturbed(const RigidTransform& camera_from_world, const Vector6& perturbation) {
    RigidTransform step = RigidTransform::Identity();
    const Eigen::Vector3d turn = perturbation.head<3>();
    const double angle = turn.norm();
    if (angle > 0) step.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    step.translation() = perturbation.tail<3>();
    RigidTransform result = camera_from_world * step;
    // Rounding of thousands of products would drift away from a rotation.
    result.linear() = Eigen::Quaterniond(result.linear()).normalized().toRotationMatrix();
    return result;
}

Vector6 perturbation_between(const RigidTransform& from, const RigidTransform& to) {
    const RigidTransform step = from.inverse() * to;
    const Eigen::AngleAxisd turn(step.linear());
    Vector6 perturbation;
    perturbation << turn.angle() * turn.axis(), step.translation();
    return perturbation;
}

TagCovariance effective_covariance(const TagObservation& seen) {
    // What no fit of one frame can know: the lens model's residual and the sheet's flatness, a few hundredths of a
    // pixel, and more on larger tags. Normalised length of a pixel = 1 / focal, had from the tag's own two sizes.
    constexpr double unmodelled_px = 0.02;
    double side_normalized = 0;
    for (int i = 0; i < 4; ++i) {
        side_normalized += (seen.corners_normalized.col(i) - seen.corners_normalized.col((i + 1) % 4)).norm() / 4;
    }
    const double sigma = unmodelled_px * side_normalized / std::max(seen.side_px, 1e-9);
    return seen.covariance + TagCovariance::Identity() * sigma * sigma;
}

TagCovariance whitening(const TagObservation& seen) {
    const TagCovariance information = effective_covariance(seen).ldlt().solve(TagCovariance::Identity());
    return Eigen::LLT<TagCovariance>(0.5 * (information + information.transpose())).matrixU();
}

std::vector<CameraPose> planar_poses(const TagObservation& seen, double size_m) {
    // OpenCV wants the corners clockwise from the upper left of the sheet: ours backwards.
    const Eigen::Matrix<double, 3, 4> corners = tag_corners_m(size_m);
    std::vector<cv::Point3d> object;
    std::vector<cv::Point2d> image;
    for (int i = 3; i >= 0; --i) {
        object.emplace_back(corners(0, i), corners(1, i), 0.0);
        image.emplace_back(seen.corners_normalized(0, i), seen.corners_normalized(1, i));
    }
    std::vector<cv::Mat> rotations, translations;
    try {
        cv::solvePnPGeneric(object, image, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations, false,
                            cv::SOLVEPNP_IPPE_SQUARE);
    } catch (const cv::Exception&) {
        return {};  // a quadrilateral no square projects to
    }
    const PlacedObservation placed{&seen, size_m, RigidTransform::Identity()};
    const std::vector<WhitenedTag> tags = whitened({placed});
    std::vector<CameraPose> poses;
    for (std::size_t i = 0; i < rotations.size(); ++i) {
        cv::Mat rotation;
        cv::Rodrigues(rotations[i], rotation);
        RigidTransform start = RigidTransform::Identity();
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) start.linear()(r, c) = rotation.at<double>(r, c);
            start.translation()(r) = translations[i].at<double>(r);
        }
        if (!start.matrix().allFinite()) continue;
        const std::optional<CameraPose> refined = minimise(tags, start);
        if (!refined) continue;
        const bool known = std::ranges::any_of(poses, [&](const CameraPose& pose) {
            return same_minimum(pose.camera_from_world, refined->camera_from_world);
        });
        if (!known) poses.push_back(*refined);
    }
    std::ranges::sort(poses, {}, &CameraPose::cost);
    return poses;
}

std::optional<CameraPose> refine_pose(const std::vector<PlacedObservation>& tags, const RigidTransform& start) {
    return minimise(whitened(tags), start);
}

std::vector<CameraPose> candidate_poses(const std::vector<PlacedObservation>& tags) {
    const std::vector<WhitenedTag> all = whitened(tags);
    std::vector<CameraPose> poses;
    for (const PlacedObservation& tag : tags) {
        for (const CameraPose& planar : planar_poses(*tag.seen, tag.size_m)) {
            const std::optional<CameraPose> refined =
                minimise(all, planar.camera_from_world * tag.world_from_tag.inverse());
            if (!refined) continue;
            const bool known = std::ranges::any_of(poses, [&](const CameraPose& pose) {
                return same_minimum(pose.camera_from_world, refined->camera_from_world);
            });
            if (!known) poses.push_back(*refined);
        }
    }
    std::ranges::sort(poses, {}, &CameraPose::cost);
    if (poses.size() > 2) poses.resize(2);
    return poses;
}

double projection_sigma_px(const CameraPose& pose, const Camera& camera, const Eigen::Vector3d& point_world_m) {
    const Eigen::Vector3d point = pose.camera_from_world * point_world_m;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << camera.fx / point.z(), 0, -camera.fx * point.x() / (point.z() * point.z()), 0, camera.fy / point.z(),
        -camera.fy * point.y() / (point.z() * point.z());
    Eigen::Matrix<double, 3, 6> by_perturbation;
    by_perturbation << -pose.camera_from_world.linear() * cross_matrix(point_world_m), pose.camera_from_world.linear();
    const Eigen::Matrix<double, 2, 6> jacobian = by_point * by_perturbation;
    return std::sqrt(std::max(0.0, (jacobian * pose.covariance * jacobian.transpose()).trace()));
}

double reprojection_rms_px(const std::vector<PlacedObservation>& tags, const RigidTransform& camera_from_world,
                           const Camera& camera) {
    double squares = 0;
    int corners = 0;
    for (const PlacedObservation& tag : tags) {
        const Eigen::Matrix<double, 3, 4> points = camera_from_world * (tag.world_from_tag * tag_corners_m(tag.size_m));
        for (int i = 0; i < 4; ++i) {
            squares += (camera.pixel_from_camera(points.col(i)) - tag.seen->corners_px.col(i)).squaredNorm();
            ++corners;
        }
    }
    return corners > 0 ? std::sqrt(squares / corners) : 0;
}

}  // namespace matchlight
