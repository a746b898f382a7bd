// Projection through the lens with its refinable parameters as unknowns, for automatic derivatives.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>
#include <ceres/ceres.h>

#include "calibration/camera.h"

namespace matchlight {

/// The parameters a clip may refine, in this order; the other coefficients stay as they were calibrated.
inline constexpr int lens_parameter_count = 6;
inline constexpr std::array<const char*, lens_parameter_count> lens_parameter_names{"fx", "fy", "cx", "cy", "k1", "k2"};
using LensVector = Eigen::Matrix<double, lens_parameter_count, 1>;

inline LensVector lens_vector(const Camera& camera) {
    LensVector lens;
    lens << camera.fx, camera.fy, camera.cx, camera.cy, 0, 0;
    for (std::size_t i = 0; i < 2 && i < camera.distortion.size(); ++i) {
        lens[static_cast<Eigen::Index>(4 + i)] = camera.distortion[i];
    }
    return lens;
}

/// `held` with the refinable parameters replaced.
inline Camera camera_with(const Camera& held, const LensVector& lens) {
    Camera camera = held;
    camera.fx = lens[0];
    camera.fy = lens[1];
    camera.cx = lens[2];
    camera.cy = lens[3];
    if (camera.distortion.empty() && (lens[4] != 0 || lens[5] != 0)) camera.distortion.assign(4, 0.0);
    if (!camera.distortion.empty()) {
        camera.distortion[0] = lens[4];
        camera.distortion[1] = lens[5];
    }
    return camera;
}

/// Camera::pixel_from_normalized over any scalar; the model is the one documented there.
class LensProjection {
public:
    explicit LensProjection(const Camera& held)
        : fisheye_(held.lens == LensModel::fisheye), tilt_(sensor_tilt_homography(held)) {
        for (std::size_t i = 0; i < held.distortion.size(); ++i) coefficients_[i] = held.distortion[i];
    }

    template <class T>
    Eigen::Matrix<T, 2, 1> pixel(const T* lens, const T& x, const T& y) const {
        using std::atan;
        using std::sqrt;
        const T k1 = lens[4], k2 = lens[5];
        const auto& k = coefficients_;
        const T r2 = x * x + y * y;
        T u = x, v = y;
        if (fisheye_) {
            // θ_d / r → 1 on the axis, where its derivative by r would divide by zero.
            if (r2 > T(1e-24)) {
                const T r = sqrt(r2), theta = atan(r), t2 = theta * theta;
                const T scale = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k[2] + t2 * k[3])))) / r;
                u = x * scale;
                v = y * scale;
            }
        } else {
            const T radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
            u = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x) + r2 * (k[8] + k[9] * r2);
            v = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y + r2 * (k[10] + k[11] * r2);
            const T w = tilt_(2, 0) * u + tilt_(2, 1) * v + tilt_(2, 2);
            const T tilted_u = (tilt_(0, 0) * u + tilt_(0, 1) * v + tilt_(0, 2)) / w;
            v = (tilt_(1, 0) * u + tilt_(1, 1) * v + tilt_(1, 2)) / w;
            u = tilted_u;
        }
        return {lens[0] * u + lens[2], lens[1] * v + lens[3]};
    }

private:
    bool fisheye_;
    std::array<double, 14> coefficients_{};
    Eigen::Matrix3d tilt_;
};

}  // namespace matchlight
