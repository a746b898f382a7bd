// Rigid transforms and the coordinate frames of the program; the only file in which axes flip.
//
// World (tag rig): z up out of the printed face, x to the right of the sheet, y to its top. Camera: x right, y down,
// z forward (OpenCV). Models: glTF's y-up. Pixel centres lie at whole numbers. Names read `target_from_source`.
#pragma once

#include <Eigen/Geometry>

namespace matchlight {

using RigidTransform = Eigen::Isometry3d;

/// Turns glTF's y-up axes into the world's z-up ones: (x, y, z) → (x, −z, y).
Eigen::Matrix3d world_from_model_axes();

/// `rotate_deg` of a scene file: about x, then y, then z of the world (R = Rz·Ry·Rx), counter-clockwise seen from the
/// axis' tip.
Eigen::Matrix3d rotation_from_degrees(const Eigen::Vector3d& rotate_deg);

/// The frame of AprilTag's library (x right, y down, z into the sheet) from the tag's own (x right, y up, z out).
Eigen::Matrix3d detector_from_tag_axes();

/// AprilTag's library counts from the corner of the first pixel; Matchlight from its centre.
inline Eigen::Vector2d pixel_from_detector(const Eigen::Vector2d& detector_px) {
    return detector_px - Eigen::Vector2d(0.5, 0.5);
}

/// The four detection corners of a tag of side `size_m` in its own frame, counter-clockwise from the lower left of the
/// printed sheet: (−,−), (+,−), (+,+), (−,+), z = 0.
Eigen::Matrix<double, 3, 4> tag_corners_m(double size_m);

/// [v]× of v × w = [v]× w.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

/// The camera at `eye` that looks along `forward` (of unit length), upright where it can be: the world's z is up in its
/// picture, or, when it looks straight up or down, the world's y.
RigidTransform camera_looking_along(const Eigen::Vector3d& eye_m, const Eigen::Vector3d& forward);

/// OpenGL clip coordinates (reversed z: near → 1, infinity → 0; y up) from OpenCV camera coordinates, for the pinhole
/// (fx, fy, cx, cy) in pixels with centres at whole numbers over a viewport of width × height pixels whose first pixel
/// is (origin_x, origin_y).
struct PinholeView {
    double fx = 1, fy = 1, cx = 0, cy = 0;
    double origin_x = 0, origin_y = 0;  // pixel index of the viewport's top-left pixel
    double width = 1, height = 1;       // viewport, in pixels of the same grid
    double near_m = 1e-3;
};
Eigen::Matrix4d clip_from_camera(const PinholeView& view);

/// 4×4 from a rigid transform and back; `from` asserts nothing: check with is_rigid first.
bool is_rigid(const Eigen::Matrix4d& matrix, double tolerance = 1e-6);

}  // namespace matchlight
