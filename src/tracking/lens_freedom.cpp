// Forward selection of lens parameters on the linearised clip.
#include "tracking/lens_freedom.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

namespace matchlight {

namespace {

using LensMask = std::array<bool, lens_parameter_count>;

/// Columns that are free when the lens is free as in `mask`.
std::vector<int> free_columns(const SharedColumns& columns, const LensMask& mask) {
    std::vector<int> result;
    for (int column = 0; column < columns.count; ++column) {
        const auto lens = std::ranges::find(columns.lens, column);
        if (lens == columns.lens.end() || mask[static_cast<std::size_t>(lens - columns.lens.begin())]) {
            result.push_back(column);
        }
    }
    return result;
}

struct Solution {
    Eigen::VectorXd step;  // of all columns, zero where held
    double gain = 0;       // what the half cost falls by
    Eigen::VectorXd sigma;
};

Solution solve(const SharedNormal& normal, const std::vector<int>& free) {
    const auto count = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd information(count, count);
    Eigen::VectorXd gradient(count);
    for (Eigen::Index a = 0; a < count; ++a) {
        gradient[a] = normal.gradient[free[static_cast<std::size_t>(a)]];
        for (Eigen::Index b = 0; b < count; ++b) {
            information(a, b) =
                normal.information(free[static_cast<std::size_t>(a)], free[static_cast<std::size_t>(b)]);
        }
    }
    const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::MatrixXd> factor(scale.asDiagonal() * information * scale.asDiagonal());
    const Eigen::VectorXd step = -scale.cwiseProduct(factor.solve(scale.cwiseProduct(gradient)));
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(count, count));
    Solution solution;
    solution.gain = -0.5 * gradient.dot(step);
    solution.step.setZero(normal.gradient.size());
    solution.sigma.setZero(normal.gradient.size());
    for (Eigen::Index a = 0; a < count; ++a) {
        solution.step[free[static_cast<std::size_t>(a)]] = step[a];
        solution.sigma[free[static_cast<std::size_t>(a)]] = scale[a] * std::sqrt(std::max(0.0, inverse(a, a)));
    }
    return solution;
}

double change(const SharedNormal& normal, const Eigen::VectorXd& step) {
    return normal.gradient.dot(step) + 0.5 * step.dot(normal.information * step);
}

class LensTest {
public:
    LensTest(std::span<const SharedNormal> blocks, const SharedColumns& columns, const ClipModel& model,
             const ModelFreedom& freedom)
        : blocks_(blocks),
          columns_(columns),
          prior_sigma_(freedom.prior.sigma),
          known_(prior_normal(model, freedom, columns)),
          all_(known_) {
        for (const SharedNormal& block : blocks) all_ += block;
    }

    /// How much better the clip fits with `more` than with `held`, when it knows `group` well enough to say.
    std::optional<double> improvement(const LensMask& held, const LensMask& more,
                                      const std::array<std::size_t, 2>& group) const {
        const std::vector<int> few = free_columns(columns_, held), many = free_columns(columns_, more);
        const Solution best = solve(all_, many);
        for (const std::size_t i : group) {
            constexpr double much_better = 0.1;
            const double sigma = best.sigma[columns_.lens[i]];
            if (!(sigma < much_better * prior_sigma_[static_cast<Eigen::Index>(i)])) return std::nullopt;
        }
        const double gain = best.gain - solve(all_, few).gain;
        // In half χ²: one for each parameter that was set free.
        if (!(gain > static_cast<double>(group.size()))) return std::nullopt;
        double unseen = 0;
        for (const SharedNormal& block : blocks_) {
            SharedNormal others = all_;
            others.information -= block.information;
            others.gradient -= block.gradient;
            unseen += change(block, solve(others, many).step) - change(block, solve(others, few).step);
        }
        if (!(unseen < static_cast<double>(group.size()))) return std::nullopt;
        return gain;
    }

private:
    std::span<const SharedNormal> blocks_;
    const SharedColumns& columns_;
    LensVector prior_sigma_;
    SharedNormal known_, all_;
};

}  // namespace

LensPrior calibration_prior(const Camera& camera) {
    LensPrior prior;
    prior.mean = lens_vector(camera);
    constexpr double focal = 0.002, principal_point = 0.002;
    prior.sigma << focal * camera.fx, focal * camera.fy, principal_point * camera.width, principal_point * camera.width,
        0.01, 0.05;
    if (camera.sigmas) {
        const CameraSigmas& known = *camera.sigmas;
        LensVector stated;
        stated << known.fx, known.fy, known.cx, known.cy, 0, 0;
        for (std::size_t i = 0; i < 2 && i < known.distortion.size(); ++i) {
            stated[static_cast<Eigen::Index>(4 + i)] = known.distortion[i];
        }
        prior.sigma = (stated.array() > 0).select(stated, prior.sigma);
    }
    prior.aspect_sigma = 0.25 * prior.sigma[0] / camera.fx;
    return prior;
}

std::array<bool, lens_parameter_count> choose_lens_freedom(std::span<const SharedNormal> blocks,
                                                           const SharedColumns& columns, const ClipModel& model,
                                                           const ModelFreedom& freedom) {
    const LensTest test(blocks, columns, model, freedom);
    std::vector<std::array<std::size_t, 2>> groups{{2, 3}, {0, 1}, {4, 5}};
    LensMask chosen{};
    while (!groups.empty()) {
        auto best = groups.end();
        LensMask best_mask{};
        double best_gain = 0;
        for (auto group = groups.begin(); group != groups.end(); ++group) {
            LensMask more = chosen;
            for (const std::size_t i : *group) more[i] = true;
            const std::optional<double> gain = test.improvement(chosen, more, *group);
            if (gain && *gain > best_gain) {
                best = group;
                best_mask = more;
                best_gain = *gain;
            }
        }
        if (best == groups.end()) break;
        chosen = best_mask;
        groups.erase(best);
    }
    return chosen;
}

}  // namespace matchlight
