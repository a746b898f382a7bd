// Irradiance of a probe, by summing over its pixels and by spherical harmonics.
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "lighting/latlong_grid.h"
#include "lighting/probe.h"

namespace matchlight {
namespace {

using std::numbers::pi;

// Normalisation of the real spherical harmonics (Ramamoorthi & Hanrahan 2001, An Efficient Representation for
// Irradiance Environment Maps, equation 3).
const double y00 = std::sqrt(1 / (4 * pi));
const double y1m = std::sqrt(3 / (4 * pi));
const double y2m = std::sqrt(15 / (4 * pi));   // xy, yz, xz
const double y20 = std::sqrt(5 / (16 * pi));   // 3z² − 1
const double y22 = std::sqrt(15 / (16 * pi));  // x² − y²

}  // namespace

Eigen::Vector3d irradiance(const Probe& probe, const Eigen::Vector3d& normal) {
    const ImageF& image = probe.latlong;
    assert(!image.empty() && image.channels() == 3);
    const LatlongGrid grid(image.width(), image.height());
    const Eigen::Vector3d n = normal.normalized();

    // n · ∫ ω dω over a pixel is exact on the lit side; only pixels that the horizon cuts are approximated, by
    // clamping their mean cosine.
    std::vector<double> horizontal(static_cast<std::size_t>(image.width()));
    for (int x = 0; x < image.width(); ++x) {
        horizontal[static_cast<std::size_t>(x)] = n.x() * grid.column(x).sine + n.y() * grid.column(x).cosine;
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = 0; y < image.height(); ++y) {
        const double vertical = n.z() * grid.row(y).sin1_cos1 * grid.azimuth_step();
        Eigen::Vector3d row_sum = Eigen::Vector3d::Zero();
        for (int x = 0; x < image.width(); ++x) {
            const double weight = vertical + grid.row(y).sin2 * horizontal[static_cast<std::size_t>(x)];
            if (weight <= 0) continue;
            const float* radiance = image.pixel(x, y);
            row_sum += weight * Eigen::Vector3d(radiance[0], radiance[1], radiance[2]);
        }
        sum += row_sum;
    }
    return sum;
}

SphericalHarmonics9 project_to_sh(const Probe& probe) {
    const ImageF& image = probe.latlong;
    assert(!image.empty() && image.channels() == 3);
    const LatlongGrid grid(image.width(), image.height());
    SphericalHarmonics9 sh;
    sh.fill(Eigen::Vector3d::Zero());
    for (int y = 0; y < image.height(); ++y) {
        // Sums along the row of radiance times each function of azimuth; the functions of height follow once a row.
        Eigen::Vector3d constant = Eigen::Vector3d::Zero();
        Eigen::Vector3d sine = constant, cosine = constant, double_sine = constant, double_cosine = constant;
        for (int x = 0; x < image.width(); ++x) {
            const float* pixel = image.pixel(x, y);
            const Eigen::Vector3d radiance(pixel[0], pixel[1], pixel[2]);
            const LatlongColumn& column = grid.column(x);
            constant += radiance;
            sine += radiance * column.sine;
            cosine += radiance * column.cosine;
            double_sine += radiance * column.double_sine;
            double_cosine += radiance * column.double_cosine;
        }
        constant *= grid.azimuth_step();
        const LatlongRow& row = grid.row(y);
        // x = sin θ sin φ, y = sin θ cos φ, z = cos θ; xy = sin² θ sin 2φ / 2, x² − y² = −sin² θ cos 2φ.
        sh[0] += y00 * row.sin1 * constant;
        sh[1] += y1m * row.sin2 * cosine;
        sh[2] += y1m * row.sin1_cos1 * constant;
        sh[3] += y1m * row.sin2 * sine;
        sh[4] += y2m * row.sin3 * double_sine / 2;
        sh[5] += y2m * row.sin2_cos1 * cosine;
        sh[6] += y20 * (3 * row.sin1_cos2 - row.sin1) * constant;
        sh[7] += y2m * row.sin2_cos1 * sine;
        sh[8] -= y22 * row.sin3 * double_cosine;
    }
    return sh;
}

Eigen::Vector3d irradiance_from_sh(const SphericalHarmonics9& sh, const Eigen::Vector3d& normal) {
    // The clamped cosine's own coefficients, A0 = π, A1 = 2π/3, A2 = π/4 (Ramamoorthi & Hanrahan 2001, equation 8).
    const double a0 = pi;
    const double a1 = 2 * pi / 3;
    const double a2 = pi / 4;
    const Eigen::Vector3d n = normal.normalized();
    return a0 * y00 * sh[0] + a1 * y1m * (n.y() * sh[1] + n.z() * sh[2] + n.x() * sh[3]) +
           a2 * (y2m * (n.x() * n.y() * sh[4] + n.y() * n.z() * sh[5] + n.x() * n.z() * sh[7]) +
                 y20 * (3 * n.z() * n.z() - 1) * sh[6] + y22 * (n.x() * n.x() - n.y() * n.y()) * sh[8]);
}

}  // namespace matchlight
