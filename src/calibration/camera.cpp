// Projection and its inverse, in the lens models of OpenCV (radial-tangential with up to 14 coefficients, and fisheye).
//
// Radial and tangential: Brown, "Decentering Distortion of Lenses" (1966); rational, thin prism and tilted sensor as
// OpenCV adds them (Louhichi et al., "A mathematical model for Scheimpflug camera", 2007). Fisheye: Kannala & Brandt,
// "A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and Fish-Eye Lenses" (2006).
#include "calibration/camera.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/error.h"

namespace matchlight {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The model needs its residual at rounding level; the contract promises 1e-10.
constexpr double converged = 1e-13;
constexpr double promised = 1e-10;

Vector2d unreachable() {
    return Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
}

double coefficient(const Camera& camera, std::size_t index) {
    return index < camera.distortion.size() ? camera.distortion[index] : 0;
}

/// Sensor coordinates before the tilt, with their derivative by the normalised ones.
struct Distorted {
    Vector2d point;
    Matrix2d jacobian;
};

Distorted distort_radtan(const Camera& camera, const Vector2d& n) {
    const double k1 = coefficient(camera, 0), k2 = coefficient(camera, 1), k3 = coefficient(camera, 4);
    const double k4 = coefficient(camera, 5), k5 = coefficient(camera, 6), k6 = coefficient(camera, 7);
    const double p1 = coefficient(camera, 2), p2 = coefficient(camera, 3);
    const double s1 = coefficient(camera, 8), s2 = coefficient(camera, 9);
    const double s3 = coefficient(camera, 10), s4 = coefficient(camera, 11);
    const double x = n.x(), y = n.y();
    const double r2 = n.squaredNorm();
    const double numerator = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double denominator = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
    const double radial = numerator / denominator;
    // By r²; the chain rule then multiplies with (2x, 2y).
    const double radial_by_r2 =
        ((k1 + r2 * (2 * k2 + r2 * 3 * k3)) * denominator - numerator * (k4 + r2 * (2 * k5 + r2 * 3 * k6))) /
        (denominator * denominator);
    const double prism_x_by_r2 = s1 + 2 * s2 * r2;
    const double prism_y_by_r2 = s3 + 2 * s4 * r2;

    Distorted d;
    d.point.x() = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + r2 * (s1 + s2 * r2);
    d.point.y() = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + r2 * (s3 + s4 * r2);
    d.jacobian(0, 0) = radial + 2 * x * (x * radial_by_r2 + prism_x_by_r2) + 2 * p1 * y + 6 * p2 * x;
    d.jacobian(0, 1) = 2 * y * (x * radial_by_r2 + prism_x_by_r2) + 2 * p1 * x + 2 * p2 * y;
    d.jacobian(1, 0) = 2 * x * (y * radial_by_r2 + prism_y_by_r2) + 2 * p1 * x + 2 * p2 * y;
    d.jacobian(1, 1) = radial + 2 * y * (y * radial_by_r2 + prism_y_by_r2) + 6 * p1 * y + 2 * p2 * x;
    return d;
}

Vector2d through_homography(const Matrix3d& homography, const Vector2d& point) {
    return (homography * point.homogeneous()).hnormalized();
}

/// Whether the model keeps its orientation all the way from the axis to `n`: there it has not folded back. 32 steps
/// resolve the polynomials' turning points, which lie a sizeable part of the image apart.
bool unfolded(const Camera& camera, const Vector2d& n) {
    constexpr int steps = 32;
    for (int i = 0; i <= steps; ++i) {
        const Matrix2d jacobian = distort_radtan(camera, n * (static_cast<double>(i) / steps)).jacobian;
        if (!(jacobian.determinant() > 0 && jacobian.trace() > 0)) return false;
    }
    return true;
}

/// Newton's method; true when the residual is within what the header promises.
bool newton_radtan(const Camera& camera, const Vector2d& target, Vector2d& n) {
    constexpr int limit = 20;  // quadratic: 4 to 6 are usual
    for (int i = 0; i < limit; ++i) {
        const Distorted d = distort_radtan(camera, n);
        const Vector2d residual = target - d.point;
        if (residual.norm() <= converged * (1 + target.norm())) return true;
        const Vector2d step = d.jacobian.inverse() * residual;
        if (!step.allFinite()) return false;
        n += step;
    }
    return (target - distort_radtan(camera, n).point).norm() <= promised;
}

/// Follows the solution outward from the axis, where it is known, so that Newton starts close on the right branch.
Vector2d continue_from_axis(const Camera& camera, const Vector2d& target) {
    constexpr int steps = 32;
    Vector2d n = Vector2d::Zero();
    const Vector2d axis = distort_radtan(camera, n).point;
    for (int i = 1; i <= steps; ++i) {
        const Vector2d waypoint = axis + (target - axis) * (static_cast<double>(i) / steps);
        if (!newton_radtan(camera, waypoint, n)) return unreachable();
    }
    return unfolded(camera, n) ? n : unreachable();
}

Vector2d undistort_radtan(const Camera& camera, const Vector2d& target) {
    Vector2d n = target;
    for (int i = 0; i < 3; ++i) {  // the fixed-point iterate of cv::undistortPoints: brings Newton near
        const Distorted d = distort_radtan(camera, n);
        n += target - d.point;
    }
    if (n.allFinite() && newton_radtan(camera, target, n) && unfolded(camera, n)) return n;
    return continue_from_axis(camera, target);
}

struct Angle {
    double theta_d;
    double derivative;
};

Angle distort_angle(const Camera& camera, double theta) {
    const double t2 = theta * theta;
    const double k1 = coefficient(camera, 0), k2 = coefficient(camera, 1);
    const double k3 = coefficient(camera, 2), k4 = coefficient(camera, 3);
    return {theta * (1 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4)))),
            1 + t2 * (3 * k1 + t2 * (5 * k2 + t2 * (7 * k3 + t2 * 9 * k4)))};
}

Vector2d distort_fisheye(const Camera& camera, const Vector2d& n) {
    const double r = n.norm();
    if (r < 1e-12) return n;  // θ_d / r → 1
    return n * (distort_angle(camera, std::atan(r)).theta_d / r);
}

Vector2d undistort_fisheye(const Camera& camera, const Vector2d& target) {
    const double theta_d = target.norm();
    if (theta_d < 1e-12) return target;
    // θ_d rises from 0: the first θ at which it reaches the target lies on the unfolded branch. March to bracket it,
    // then bisect with Newton.
    constexpr int steps = 64;
    constexpr double end = std::numbers::pi / 2;  // the plane z = 1 ends there
    double low = 0, high = end;
    bool bracketed = false;
    for (int i = 1; i <= steps && !bracketed; ++i) {
        const double theta = end * i / steps;
        const Angle angle = distort_angle(camera, theta);
        if (angle.theta_d >= theta_d) {
            high = theta;
            bracketed = true;
        } else if (!(angle.derivative > 0)) {
            return unreachable();
        } else {
            low = theta;
        }
    }
    if (!bracketed) return unreachable();
    double theta = (low + high) / 2;
    for (int i = 0; i < 60; ++i) {
        const Angle angle = distort_angle(camera, theta);
        const double residual = theta_d - angle.theta_d;
        if (std::abs(residual) <= 1e-15) break;
        (residual > 0 ? low : high) = theta;
        const double newton = theta + residual / angle.derivative;
        theta = newton > low && newton < high ? newton : (low + high) / 2;
    }
    if (std::abs(distort_angle(camera, theta).theta_d - theta_d) > promised || theta >= end) return unreachable();
    return target * (std::tan(theta) / theta_d);
}

}  // namespace

Eigen::Matrix3d sensor_tilt_homography(const Camera& camera) {
    const double tau_x = coefficient(camera, 12), tau_y = coefficient(camera, 13);
    if (tau_x == 0 && tau_y == 0) return Matrix3d::Identity();
    const double cx = std::cos(tau_x), sx = std::sin(tau_x), cy = std::cos(tau_y), sy = std::sin(tau_y);
    Matrix3d about_x, about_y, onto_plane;
    about_x << 1, 0, 0, 0, cx, sx, 0, -sx, cx;
    about_y << cy, 0, -sy, 0, 1, 0, sy, 0, cy;
    const Matrix3d rotation = about_y * about_x;
    onto_plane << rotation(2, 2), 0, -rotation(0, 2), 0, rotation(2, 2), -rotation(1, 2), 0, 0, 1;
    return onto_plane * rotation;
}

bool valid_distortion_count(LensModel lens, std::size_t count) {
    if (lens == LensModel::fisheye) return count == 0 || count == 4;
    return count == 0 || count == 4 || count == 5 || count == 8 || count == 12 || count == 14;
}

Eigen::Matrix3d Camera::matrix() const {
    Matrix3d k;
    k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
    return k;
}

bool Camera::has_distortion() const {
    // A fisheye lens without coefficients still bends: θ_d = θ is not the pinhole's tan θ.
    return lens == LensModel::fisheye ||
           std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; });
}

Eigen::Vector2d Camera::pixel_from_normalized(const Eigen::Vector2d& normalized) const {
    Vector2d sensor = normalized;
    if (lens == LensModel::fisheye) {
        sensor = distort_fisheye(*this, normalized);
    } else if (has_distortion()) {
        sensor = through_homography(sensor_tilt_homography(*this), distort_radtan(*this, normalized).point);
    }
    return {fx * sensor.x() + cx, fy * sensor.y() + cy};
}

Eigen::Vector2d Camera::normalized_from_pixel(const Eigen::Vector2d& pixel) const {
    assert(fx > 0 && fy > 0);
    Vector2d sensor((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
    if (!sensor.allFinite()) return unreachable();
    if (lens == LensModel::fisheye) return undistort_fisheye(*this, sensor);
    if (!has_distortion()) return sensor;
    return undistort_radtan(*this, through_homography(sensor_tilt_homography(*this).inverse(), sensor));
}

Camera camera_for_size(const Camera& camera, int width, int height, const std::filesystem::path& reported) {
    if (width == camera.width && height == camera.height) return camera;
    const double scale_x = static_cast<double>(width) / camera.width;
    const double scale_y = static_cast<double>(height) / camera.height;
    if (width <= 0 || height <= 0 || std::abs(scale_x / scale_y - 1) > 0.01) {
        throw InputError(reported,
                         "the camera was calibrated at " + std::to_string(camera.width) + "x" +
                             std::to_string(camera.height) + ", the footage is " + std::to_string(width) + "x" +
                             std::to_string(height) + ", of another shape",
                         "calibrate with the footage's own picture format");
    }
    Camera scaled = camera;
    scaled.width = width;
    scaled.height = height;
    scaled.fx *= scale_x;
    scaled.fy *= scale_y;
    // Edges scale, not centres: the left edge of the picture is at −0.5.
    scaled.cx = (camera.cx + 0.5) * scale_x - 0.5;
    scaled.cy = (camera.cy + 0.5) * scale_y - 0.5;
    if (scaled.sigmas) {
        scaled.sigmas->fx *= scale_x;
        scaled.sigmas->fy *= scale_y;
        scaled.sigmas->cx *= scale_x;
        scaled.sigmas->cy *= scale_y;
    }
    return scaled;
}

}  // namespace matchlight
