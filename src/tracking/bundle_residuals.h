// Residuals of the bundle adjustment: a tag's corners in pixels, and what is known beforehand.
#pragma once

#include <Eigen/Core>
#include <ceres/rotation.h>

#include "tracking/clip_model.h"

namespace matchlight {

/// target ← Exp(ξ)·source, ξ = (rotation vector, translation).
template <class T>
Eigen::Matrix<T, 3, 1> moved_point(const T* perturbation, const Eigen::Matrix<T, 3, 1>& point) {
    Eigen::Matrix<T, 3, 1> result;
    ceres::AngleAxisRotatePoint(perturbation, point.data(), result.data());
    for (int k = 0; k < 3; ++k) result[k] += perturbation[3 + k];
    return result;
}

/// A tag in a frame: eight whitened residuals in pixels, through the exact lens. Pose and place are perturbations on
/// the right of their references, so that derivatives at zero are those that covariances are about.
struct TagPixelResidual {
    LensProjection lens;
    RigidTransform camera_from_world, world_from_tag;  // references
    Eigen::Matrix<double, 3, 4> corners_tag_m;
    TagCorners measured_px;
    TagCovariance whitening;
    PoseVector velocity = PoseVector::Zero();                 // of the camera, perturbation a second
    Eigen::Vector4d readout_phase = Eigen::Vector4d::Zero();  // of each corner's row, −½ first row to ½ last

    template <class T>
    bool operator()(const T* pose, const T* place, const T* offsets, const T* lens_parameters, const T* readout_s,
                    T* residual) const {
        using Vector3 = Eigen::Matrix<T, 3, 1>;
        Eigen::Matrix<T, 8, 1> difference;
        for (int i = 0; i < 4; ++i) {
            const Vector3 sheet(corners_tag_m(0, i) + offsets[2 * i], corners_tag_m(1, i) + offsets[2 * i + 1],
                                T(corners_tag_m(2, i)));
            Vector3 world =
                world_from_tag.linear().cast<T>() * moved_point(place, sheet) + world_from_tag.translation().cast<T>();
            // The row was read a little before or after the middle one: the camera had moved on by so much.
            const T elapsed_s = readout_s[0] * readout_phase[i];
            const Eigen::Matrix<T, 6, 1> step = velocity.cast<T>() * elapsed_s;
            world = moved_point(step.data(), world);
            const Vector3 camera = camera_from_world.linear().cast<T>() * moved_point(pose, world) +
                                   camera_from_world.translation().cast<T>();
            if (camera.z() < T(1e-6)) return false;
            const Eigen::Matrix<T, 2, 1> px =
                lens.pixel(lens_parameters, T(camera.x() / camera.z()), T(camera.y() / camera.z()));
            difference.template segment<2>(2 * i) = px - measured_px.col(i).template cast<T>();
        }
        Eigen::Map<Eigen::Matrix<T, 8, 1>>(residual, 8) = whitening.cast<T>() * difference;
        return true;
    }
};

/// Corner offsets are small: standard deviation sigma_m.
struct OffsetPrior {
    double sigma_m;
    template <class T>
    bool operator()(const T* offsets, T* residual) const {
        for (int i = 0; i < 8; ++i) residual[i] = offsets[i] / sigma_m;
        return true;
    }
};

/// Read-out time: about zero, or what a sensor takes.
struct ReadoutPrior {
    double sigma_s;
    template <class T>
    bool operator()(const T* readout_s, T* residual) const {
        residual[0] = readout_s[0] / sigma_s;
        return true;
    }
};

/// Calibrated values and how well they are known; the ratio of the focal lengths better than each.
struct LensPriorResidual {
    LensPrior prior;
    template <class T>
    bool operator()(const T* lens, T* residual) const {
        for (int i = 0; i < lens_parameter_count; ++i) residual[i] = (lens[i] - prior.mean[i]) / prior.sigma[i];
        residual[1] = (lens[1] / lens[0] * (prior.mean[0] / prior.mean[1]) - 1.0) / prior.aspect_sigma;
        return true;
    }
};

/// A sheet lies on the plane: its middle and, at half its size to the right and to the top, its tilt.
struct OnPlaneResidual {
    RigidTransform world_from_tag, world_from_plane;  // references
    double half_size_m, sigma_m;

    template <class T>
    bool operator()(const T* place, const T* plane, T* residual) const {
        using Vector3 = Eigen::Matrix<T, 3, 1>;
        const T plane_step[6] = {plane[0], plane[1], T(0), T(0), T(0), plane[2]};
        const Vector3 zero = Vector3::Zero();
        const Vector3 up(T(0), T(0), T(1));
        const Vector3 origin = world_from_plane.linear().cast<T>() * moved_point(plane_step, zero) +
                               world_from_plane.translation().cast<T>();
        const Vector3 above = world_from_plane.linear().cast<T>() * moved_point(plane_step, up) +
                              world_from_plane.translation().cast<T>();
        const Vector3 normal = above - origin;
        const auto height = [&](double x, double y) -> T {
            const Vector3 sheet(T(x), T(y), T(0));
            const Vector3 world =
                world_from_tag.linear().cast<T>() * moved_point(place, sheet) + world_from_tag.translation().cast<T>();
            return normal.dot(world - origin);
        };
        const T middle = height(0, 0);
        residual[0] = middle / sigma_m;
        residual[1] = (height(half_size_m, 0) - middle) / sigma_m;
        residual[2] = (height(0, half_size_m) - middle) / sigma_m;
        return true;
    }
};

}  // namespace matchlight
