// Integrates the GGX directional albedo over visible normals.
#include "render/split_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace matchlight {

namespace {

/// Van der Corput's sequence in base 2.
double radical_inverse(std::uint32_t bits) {
    std::uint32_t reversed = 0;
    for (int i = 0; i < 32; ++i) reversed |= ((bits >> i) & 1U) << (31 - i);
    return reversed * 0x1p-32;
}

/// A normal of the GGX distribution as seen from `view` (Heitz 2018, "Sampling the GGX Distribution of Visible
/// Normals").
Eigen::Vector3d visible_normal(const Eigen::Vector3d& view, double alpha, double u1, double u2) {
    const Eigen::Vector3d stretched = Eigen::Vector3d(alpha * view.x(), alpha * view.y(), view.z()).normalized();
    const double length2 = stretched.head<2>().squaredNorm();
    const Eigen::Vector3d t1 =
        length2 > 0 ? Eigen::Vector3d(Eigen::Vector3d(-stretched.y(), stretched.x(), 0) / std::sqrt(length2))
                    : Eigen::Vector3d(1, 0, 0);
    const Eigen::Vector3d t2 = stretched.cross(t1);
    const double radius = std::sqrt(u1);
    const double angle = 2 * std::numbers::pi * u2;
    const double x = radius * std::cos(angle);
    const double s = (1 + stretched.z()) / 2;
    const double y = (1 - s) * std::sqrt(std::max(0.0, 1 - x * x)) + s * radius * std::sin(angle);
    const Eigen::Vector3d normal = x * t1 + y * t2 + std::sqrt(std::max(0.0, 1 - x * x - y * y)) * stretched;
    return Eigen::Vector3d(alpha * normal.x(), alpha * normal.y(), std::max(0.0, normal.z())).normalized();
}

/// Smith's Λ of the GGX distribution.
double smith_lambda(double cosine, double alpha) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

}  // namespace

Eigen::Vector2d split_sum(double n_dot_v, double roughness, int samples) {
    const double alpha = roughness * roughness;
    const Eigen::Vector3d view(std::sqrt(1 - n_dot_v * n_dot_v), 0, n_dot_v);
    const double view_lambda = smith_lambda(n_dot_v, alpha);
    double scale = 0;
    double bias = 0;
    for (int i = 0; i < samples; ++i) {
        const Eigen::Vector3d half =
            visible_normal(view, alpha, (i + 0.5) / samples, radical_inverse(static_cast<std::uint32_t>(i)));
        const double v_dot_h = view.dot(half);
        const Eigen::Vector3d light = 2 * v_dot_h * half - view;
        if (light.z() <= 0) continue;
        // G2 / G1 of visible-normal sampling.
        const double weight = (1 + view_lambda) / (1 + view_lambda + smith_lambda(light.z(), alpha));
        const double fresnel = std::pow(1 - std::clamp(v_dot_h, 0.0, 1.0), 5);
        scale += (1 - fresnel) * weight;
        bias += fresnel * weight;
    }
    return Eigen::Vector2d(scale, bias) / samples;
}

ImageF split_sum_table(int size, int samples) {
    ImageF table(size, size, 2);
    parallel_for(size, [&](int row) {
        for (int column = 0; column < size; ++column) {
            const Eigen::Vector2d value = split_sum((column + 0.5) / size, (row + 0.5) / size, samples);
            table.at(column, row, 0) = static_cast<float>(value.x());
            table.at(column, row, 1) = static_cast<float>(value.y());
        }
    });
    return table;
}

}  // namespace matchlight
