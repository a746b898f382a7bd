// Iteratively reweighted least squares on a plane.
#include "tracking/robust_plane.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/median.h"

namespace matchlight {

PlaneFit fit_robust_plane(const std::vector<PlaneSample>& samples, double least_spread) {
    std::vector<double> values;
    for (const PlaneSample& sample : samples) values.push_back(sample.value);
    Eigen::Vector3d plane(upper_median(values), 0, 0);
    // Fewer samples than this do not tell a slope from a shadow.
    constexpr std::size_t enough_for_slope = 8;
    const bool sloped = samples.size() >= enough_for_slope;
    double spread = 0, weights = 0;
    constexpr int rounds = 12;
    for (int round = 0; round < rounds; ++round) {
        std::vector<double> away;
        for (const PlaneSample& sample : samples) {
            away.push_back(std::abs(sample.value - plane.dot(Eigen::Vector3d(1, sample.a, sample.b))));
        }
        // Samples that agree to the last bits have no spread to judge others by.
        const double rounding = 1e-9 * (std::abs(plane[0]) + 1e-9);
        const double scale = std::max({1.4826 * upper_median(away), least_spread, rounding});
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        spread = weights = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const Eigen::Vector3d row(1, samples[i].a, samples[i].b);
            const double ratio = away[i] / (2 * scale);
            const double robust = 1 / (1 + ratio * ratio);
            normal += robust * samples[i].weight * row * row.transpose();
            right += robust * samples[i].weight * row * samples[i].value;
            spread += robust * away[i] * away[i];
            weights += robust;
        }
        if (sloped) {
            normal.diagonal().array() += 1e-9 * normal(0, 0);
            plane = normal.ldlt().solve(right);
        } else {
            plane = {right[0] / normal(0, 0), 0, 0};
        }
    }
    return {plane[0], std::sqrt(spread / weights / std::max(1.0, weights - (sloped ? 3 : 1)))};
}

}  // namespace matchlight
