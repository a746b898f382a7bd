// The calls into libapriltag and OpenCV.
#include "report/pose_peers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>

#include <Eigen/SVD>
#include <apriltag/apriltag_pose.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace matchlight {

namespace {

/// Lengths that libraries meet as pixels: their stopping rules suppose such a scale.
constexpr double peer_focal_px = 1000;

/// The library does not export its own making and freeing of matrices: one block each, from calloc.
using Matd = std::unique_ptr<matd_t, void (*)(void*)>;

Matd matd_of(const cv::Matx33d& matrix) {
    Matd made(static_cast<matd_t*>(std::calloc(1, sizeof(matd_t) + sizeof(matrix.val))), std::free);
    if (!made) throw std::bad_alloc();
    made->nrows = made->ncols = 3;
    std::ranges::copy(matrix.val, made->data);
    return made;
}

RigidTransform from_rodrigues(const cv::Vec3d& turn, const cv::Vec3d& shift) {
    RigidTransform pose = RigidTransform::Identity();
    const Eigen::Vector3d rotation(turn[0], turn[1], turn[2]);
    if (rotation.norm() > 0) pose.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).matrix();
    pose.translation() = Eigen::Vector3d(shift[0], shift[1], shift[2]);
    return pose;
}

/// Of the poses offered, the one that has all points in front of the camera and leaves the least squared residual.
struct BestPose {
    double squared_px = std::numeric_limits<double>::infinity();
    std::optional<RigidTransform> pose;

    void offer(const RigidTransform& camera_from_points, const Eigen::Matrix3Xd& points_m,
               const std::vector<cv::Point2d>& seen_px) {
        if (!camera_from_points.matrix().allFinite()) return;
        double squared = 0;
        for (std::size_t i = 0; i < seen_px.size(); ++i) {
            const Eigen::Vector3d point = camera_from_points * points_m.col(static_cast<Eigen::Index>(i));
            if (!(point.z() > 0)) return;
            squared +=
                (peer_focal_px * point.hnormalized() - Eigen::Vector2d(seen_px[i].x, seen_px[i].y)).squaredNorm();
        }
        if (squared < squared_px) squared_px = squared, pose = camera_from_points;
    }
};

cv::Matx33d camera_matrix() {
    return {peer_focal_px, 0, 0, 0, peer_focal_px, 0, 0, 0, 1};
}

/// IPPE's pose of points in a plane z = 0. It is asked for both sides of the plane: OpenCV turns the points onto a
/// plane of its own making, whose side follows from rounding, and loses its digits where the turn that it returns is by
/// 180°.
std::optional<RigidTransform> ippe_pose_of_plane(const Eigen::Matrix3Xd& points_m,
                                                 const std::vector<cv::Point2d>& seen_px) {
    BestPose best;
    for (const double side : {1.0, -1.0}) {
        const RigidTransform turned_from_plane(Eigen::Vector3d(1, side, side).asDiagonal());
        std::vector<cv::Point3d> turned;
        for (const auto& point : points_m.colwise()) turned.emplace_back(point.x(), side * point.y(), 0);
        std::vector<cv::Vec3d> turns, shifts;
        cv::solvePnPGeneric(turned, seen_px, camera_matrix(), cv::noArray(), turns, shifts, false, cv::SOLVEPNP_IPPE);
        for (std::size_t i = 0; i < turns.size(); ++i)
            best.offer(from_rodrigues(turns[i], shifts[i]) * turned_from_plane, points_m, seen_px);
    }
    return best.pose;
}

/// The frame of the plane through points: z = 0 at their middle, x along their largest extent.
struct FittedPlane {
    RigidTransform plane_from_world = RigidTransform::Identity();
    /// Smallest extent of the points over their largest.
    double flatness = 0;
};

FittedPlane fitted_plane(const std::vector<SeenPoint>& points) {
    Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = points[i].world_m;
    const Eigen::Vector3d middle = all.rowwise().mean();
    all.colwise() -= middle;
    const Eigen::JacobiSVD<Eigen::Matrix3Xd> extents(all, Eigen::ComputeFullU);
    Eigen::Matrix3d world_from_plane = extents.matrixU();
    if (world_from_plane.determinant() < 0) world_from_plane.col(2) *= -1;
    FittedPlane plane;
    plane.plane_from_world.linear() = world_from_plane.transpose();
    plane.plane_from_world.translation() = -world_from_plane.transpose() * middle;
    plane.flatness = extents.singularValues().z() / extents.singularValues().x();
    return plane;
}

std::optional<RigidTransform> ippe_pose_of_flat(const std::vector<SeenPoint>& points, const FittedPlane& plane,
                                                const std::vector<cv::Point2d>& seen_px) {
    Eigen::Matrix3Xd in_plane(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
        in_plane.col(static_cast<Eigen::Index>(i)) = plane.plane_from_world * points[i].world_m;
    const std::optional<RigidTransform> camera_from_plane = ippe_pose_of_plane(in_plane, seen_px);
    if (!camera_from_plane) return std::nullopt;
    return *camera_from_plane * plane.plane_from_world;
}

}  // namespace

std::optional<TagCorners> normalized_corners(const TagDetection& detection, const Camera& camera) {
    TagCorners corners;
    for (int i = 0; i < 4; ++i) {
        corners.col(i) = camera.normalized_from_pixel(detection.corners_px[static_cast<std::size_t>(i)]);
    }
    if (!corners.allFinite()) return std::nullopt;
    return corners;
}

RigidTransform apriltag_pose(const TagCorners& corners_normalized, double size_m) {
    apriltag_detection_t detection{};
    std::vector<cv::Point2f> ideal{{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}, seen;
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d px = peer_focal_px * corners_normalized.col(i);
        detection.p[i][0] = px.x(), detection.p[i][1] = px.y();
        seen.emplace_back(static_cast<float>(px.x()), static_cast<float>(px.y()));
    }
    // Only where the iteration starts.
    const Matd start = matd_of(cv::getPerspectiveTransform(ideal, seen));
    detection.H = start.get();
    apriltag_detection_info_t info{&detection, size_m, peer_focal_px, peer_focal_px, 0, 0};
    apriltag_pose_t found{};
    estimate_tag_pose(&info, &found);
    const Matd rotation(found.R, std::free), shift(found.t, std::free);
    Eigen::Matrix3d camera_from_detector;
    for (unsigned row = 0; row < 3; ++row) {
        for (unsigned column = 0; column < 3; ++column)
            camera_from_detector(row, column) = MATD_EL(found.R, row, column);
    }
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = camera_from_detector * detector_from_tag_axes();
    for (unsigned row = 0; row < 3; ++row) pose.translation()(row) = MATD_EL(found.t, row, 0);
    return pose;
}

std::optional<RigidTransform> ippe_pose(const TagCorners& corners_normalized, double size_m) {
    std::vector<cv::Point2d> seen_px;
    for (const auto& corner : corners_normalized.colwise())
        seen_px.emplace_back(peer_focal_px * corner.x(), peer_focal_px * corner.y());
    return ippe_pose_of_plane(tag_corners_m(size_m), seen_px);
}

std::optional<RigidTransform> solve_pnp_pose(const std::vector<SeenPoint>& points) {
    constexpr std::size_t least_points = 4;
    if (points.size() < least_points) return std::nullopt;
    std::vector<cv::Point3d> world;
    std::vector<cv::Point2d> seen_px;
    for (const SeenPoint& point : points) {
        world.emplace_back(point.world_m.x(), point.world_m.y(), point.world_m.z());
        seen_px.emplace_back(peer_focal_px * point.normalized.x(), peer_focal_px * point.normalized.y());
    }
    constexpr double flat = 1e-3;
    const FittedPlane plane = fitted_plane(points);
    cv::Vec3d turn, shift;
    try {
        if (plane.flatness < flat) {
            const std::optional<RigidTransform> start = ippe_pose_of_flat(points, plane, seen_px);
            if (!start) return std::nullopt;
            const Eigen::AngleAxisd axis(start->linear());
            const Eigen::Vector3d rotation = axis.angle() * axis.axis();
            for (int i = 0; i < 3; ++i) turn[i] = rotation[i], shift[i] = start->translation()[i];
        } else if (!cv::solvePnP(world, seen_px, camera_matrix(), cv::noArray(), turn, shift, false,
                                 cv::SOLVEPNP_SQPNP)) {
            return std::nullopt;
        }
        cv::solvePnPRefineLM(world, seen_px, camera_matrix(), cv::noArray(), turn, shift);
    } catch (const cv::Exception&) {
        return std::nullopt;  // points that no pose explains
    }
    const RigidTransform pose = from_rodrigues(turn, shift);
    if (!pose.matrix().allFinite()) return std::nullopt;
    return pose;
}

}  // namespace matchlight
