// The calls into libapriltag and OpenCV.
#include "report/pose_peers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
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
constexpr double focal_px = 1000;

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

/// Smallest extent of the points over their largest.
double flatness(const std::vector<SeenPoint>& points) {
    Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = points[i].world_m;
    all.colwise() -= all.rowwise().mean().eval();
    const Eigen::Vector3d extents = Eigen::JacobiSVD<Eigen::Matrix3Xd>(all).singularValues();
    return extents.z() / extents.x();
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
        const Eigen::Vector2d px = focal_px * corners_normalized.col(i);
        detection.p[i][0] = px.x(), detection.p[i][1] = px.y();
        seen.emplace_back(static_cast<float>(px.x()), static_cast<float>(px.y()));
    }
    // Only where the iteration starts.
    const Matd start = matd_of(cv::getPerspectiveTransform(ideal, seen));
    detection.H = start.get();
    apriltag_detection_info_t info{&detection, size_m, focal_px, focal_px, 0, 0};
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
    const Eigen::Matrix<double, 3, 4> corners_m = tag_corners_m(size_m);
    std::vector<cv::Point3d> tag;
    std::vector<cv::Point2d> seen;
    for (int i = 0; i < 4; ++i) {
        tag.emplace_back(corners_m(0, i), corners_m(1, i), corners_m(2, i));
        seen.emplace_back(focal_px * corners_normalized(0, i), focal_px * corners_normalized(1, i));
    }
    std::vector<cv::Vec3d> turns, shifts;
    const int count = cv::solvePnPGeneric(tag, seen, cv::Matx33d(focal_px, 0, 0, 0, focal_px, 0, 0, 0, 1),
                                          cv::noArray(), turns, shifts, false, cv::SOLVEPNP_IPPE);
    if (count < 1) return std::nullopt;
    const RigidTransform pose = from_rodrigues(turns[0], shifts[0]);  // sorted by reprojection error
    if (!pose.matrix().allFinite()) return std::nullopt;
    return pose;
}

std::optional<RigidTransform> solve_pnp_pose(const std::vector<SeenPoint>& points) {
    constexpr std::size_t least_points = 4;
    if (points.size() < least_points) return std::nullopt;
    std::vector<cv::Point3d> world;
    std::vector<cv::Point2d> seen;
    for (const SeenPoint& point : points) {
        world.emplace_back(point.world_m.x(), point.world_m.y(), point.world_m.z());
        seen.emplace_back(focal_px * point.normalized.x(), focal_px * point.normalized.y());
    }
    constexpr double flat = 1e-3;
    const cv::Matx33d camera(focal_px, 0, 0, 0, focal_px, 0, 0, 0, 1);
    cv::Vec3d turn, shift;
    try {
        const int method = flatness(points) < flat ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP;
        if (!cv::solvePnP(world, seen, camera, cv::noArray(), turn, shift, false, method)) return std::nullopt;
        cv::solvePnPRefineLM(world, seen, camera, cv::noArray(), turn, shift);
    } catch (const cv::Exception&) {
        return std::nullopt;  // points that no pose explains
    }
    const RigidTransform pose = from_rodrigues(turn, shift);
    if (!pose.matrix().allFinite()) return std::nullopt;
    return pose;
}

}  // namespace matchlight
