// Projection through a lens for any number type, so that Ceres can differentiate it: the formulas of camera.cpp.
#pragma once

#include <array>
#include <cmath>

#include "calibration/camera.h"

namespace matchlight {

/// fx fy cx cy, then eight coefficients in OpenCV's order (k1 k2 p1 p2 k3 k4 k5 k6, or a fisheye lens's k1 to k4).
constexpr int lens_parameters = 12;
using LensParameters = std::array<double, lens_parameters>;

/// Pixel of a point in camera coordinates; false behind a lens that sees only what lies in front.
template <class T>
bool project(LensModel lens, const T* lens_values, const T* point, T* px) {
    using std::atan2;
    using std::sqrt;
    const T* k = lens_values + 4;
    T x, y;
    if (lens == LensModel::fisheye) {
        const T r2 = point[0] * point[0] + point[1] * point[1];
        if (r2 < 1e-24 * point[2] * point[2]) {  // on the axis θ_d / r is 1 / z, and √ has no derivative
            if (point[2] <= 0.0) return false;
            x = point[0] / point[2];
            y = point[1] / point[2];
        } else {
            const T r = sqrt(r2);
            const T theta = atan2(r, point[2]);
            const T t2 = theta * theta;
            const T bent = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
            x = point[0] * bent / r;
            y = point[1] * bent / r;
        }
    } else {
        if (point[2] <= 0.0) return false;
        const T nx = point[0] / point[2], ny = point[1] / point[2];
        const T r2 = nx * nx + ny * ny;
        const T radial = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
        x = nx * radial + 2.0 * k[2] * nx * ny + k[3] * (r2 + 2.0 * nx * nx);
        y = ny * radial + k[2] * (r2 + 2.0 * ny * ny) + 2.0 * k[3] * nx * ny;
    }
    px[0] = lens_values[0] * x + lens_values[2];
    px[1] = lens_values[1] * y + lens_values[3];
    return true;
}

}  // namespace matchlight
