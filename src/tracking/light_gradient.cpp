// A robust linear function through a few tags.
#include "tracking/light_gradient.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace matchlight {

std::optional<Eigen::Vector3d> fit_light_gradient(const std::vector<TagLight>& tags) {
    constexpr std::size_t fewest = 3;
    if (tags.size() < fewest) return std::nullopt;
    // Prints differ by about this from tag to tag, in any light.
    constexpr double print_sigma = 0.015;
    // Light that doubles over 20 cm is steeper than what an even gradient describes.
    constexpr double gradient_sigma = 3.5;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const TagLight& tag : tags) middle += tag.place_m / static_cast<double>(tags.size());

    Eigen::Vector4d solution = Eigen::Vector4d::Zero();
    Eigen::Matrix4d normal;
    double squares = 0, weights = 0;
    constexpr int rounds = 20;
    for (int round = 0; round < rounds; ++round) {
        normal.setZero();
        normal.bottomRightCorner<3, 3>().diagonal().array() += 1 / (gradient_sigma * gradient_sigma);
        Eigen::Vector4d right = Eigen::Vector4d::Zero();
        squares = weights = 0;
        for (const TagLight& tag : tags) {
            Eigen::Vector4d row;
            row << 1, tag.place_m - middle;
            const double residual = tag.log_light - row.dot(solution);
            // The first round has no solution to judge by. Three tags are always met, more may hold one in a shadow.
            constexpr double knee = 3 * print_sigma;
            const double robust = round == 0 ? 1 : 1 / (1 + residual * residual / (knee * knee));
            normal += robust / (print_sigma * print_sigma) * row * row.transpose();
            right += robust / (print_sigma * print_sigma) * row * tag.log_light;
            squares += robust * residual * residual;
            weights += robust;
        }
        solution = normal.ldlt().solve(right);
    }
    const double freedom = std::max(1.0, weights - 3);
    const double scatter = std::sqrt(squares / freedom);
    const double inflation = std::max(1.0, scatter * scatter / (print_sigma * print_sigma));
    const Eigen::Vector3d gradient = solution.tail<3>();
    const Eigen::Matrix3d covariance = normal.inverse().bottomRightCorner<3, 3>() * inflation;
    // 99.9 % of a χ² of three.
    constexpr double clear = 16.3;
    if (gradient.dot(covariance.ldlt().solve(gradient)) < clear) return std::nullopt;
    return gradient;
}

}  // namespace matchlight
