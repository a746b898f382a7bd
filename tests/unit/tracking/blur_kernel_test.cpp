// The fitted variance against a least-squares fit of the model's edge to edges drawn by brute force.
#include "tracking/blur_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr double step_px = 0.02, reach_px = 14;

/// A spread function on a grid of steps, and what becomes of a step edge.
class Edge {
public:
    Edge() : spread_(static_cast<std::size_t>(2 * reach_px / step_px) + 1, 0.0) { spread_[spread_.size() / 2] = 1; }

    template <class Spread>
    Edge& blurred_by(double radius, Spread spread) {
        const int reach = static_cast<int>(std::ceil(radius / step_px));
        std::vector<double> weights;
        double sum = 0;
        for (int i = -reach; i <= reach; ++i) {
            // Means over a step, so that ends count by their share.
            double weight = 0;
            constexpr int parts = 16;
            for (int part = 0; part < parts; ++part) weight += spread((i - 0.5 + (part + 0.5) / parts) * step_px);
            weights.push_back(weight);
            sum += weight;
        }
        std::vector<double> result(spread_.size(), 0.0);
        const auto count = static_cast<int>(spread_.size());
        for (int i = 0; i < count; ++i) {
            if (spread_[static_cast<std::size_t>(i)] == 0) continue;
            for (int k = -reach; k <= reach; ++k) {
                if (i + k < 0 || i + k >= count) continue;
                result[static_cast<std::size_t>(i + k)] +=
                    spread_[static_cast<std::size_t>(i)] * weights[static_cast<std::size_t>(k + reach)] / sum;
            }
        }
        spread_ = std::move(result);
        return *this;
    }
    Edge& box(double width) {
        if (width < 1e-9) return *this;
        return blurred_by(width / 2 + step_px, [&](double x) { return std::abs(x) < width / 2 ? 1.0 : 0.0; });
    }
    Edge& disc(double diameter) {
        if (diameter < 1e-9) return *this;
        const double radius = diameter / 2;
        return blurred_by(radius + step_px,
                          [&](double x) { return std::sqrt(std::max(0.0, radius * radius - x * x)); });
    }
    Edge& gaussian(double variance) {
        return blurred_by(6 * std::sqrt(variance), [&](double x) { return std::exp(-x * x / (2 * variance)); });
    }

    std::vector<double> profile() const {
        std::vector<double> sums;
        double sum = 0;
        for (const double value : spread_) sums.push_back(sum += value);
        return sums;
    }

private:
    std::vector<double> spread_;
};

/// The variance of the Gaussian whose edge, seen through a unit box, is nearest in least squares.
double nearest_gaussian(const std::vector<double>& seen) {
    const auto distance = [&](double variance) {
        // The unit box and a Gaussian in closed form: ψ(z) = zΦ(z) + φ(z).
        const double sigma = std::sqrt(variance);
        const auto psi = [&](double x) {
            const double z = x / sigma;
            return sigma * (z * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
                            std::exp(-z * z / 2) * std::numbers::inv_sqrtpi / std::numbers::sqrt2);
        };
        double sum = 0;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const double x = (static_cast<double>(i) + 0.5) * step_px - step_px / 2 - reach_px;
            const double off = seen[i] - (psi(x + step_px / 2 + 0.5) - psi(x + step_px / 2 - 0.5));
            sum += off * off;
        }
        return sum;
    };
    double low = 1e-3, high = 20;
    constexpr double golden = 0.6180339887498949;
    while (high - low > 1e-6) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
    }
    return (low + high) / 2;
}

TEST(BlurKernel, FitsWhatLeastSquaresFits) {
    for (const double gaussian : {0.05, 0.25, 1.0}) {
        for (const double disc : {0.0, 0.2, 2.0}) {
            for (const double motion : {0.0, 0.5}) {
                EdgeKernel kernel{disc, motion, gaussian};
                const Edge edge =
                    Edge().box(1).disc(4 * std::sqrt(disc)).box(std::sqrt(12 * motion)).gaussian(gaussian);
                const double expected = nearest_gaussian(edge.profile());
                EXPECT_NEAR(fitted_variance(kernel).value, expected, 2e-3 + 2e-3 * expected)
                    << gaussian << " " << disc << " " << motion;
            }
        }
    }
}

TEST(BlurKernel, PixelsAslantHaveATriangularFootprint) {
    const double half = std::sqrt(0.5);
    const Edge edge = Edge().box(half).box(half).gaussian(0.1);
    EXPECT_NEAR(fitted_variance({0, 0, 0.1, {half, half}}).value, nearest_gaussian(edge.profile()), 1e-3);
}

TEST(BlurKernel, WideKernelsKeepTheirRatio) {
    // Scale-free far above the pixel: what the comment in the header states.
    EXPECT_NEAR(fitted_variance({0, 20, 0.1}).value / 20, 1.23, 0.01);
    EXPECT_NEAR(fitted_variance({20, 0, 0.1}).value / 20, 1.18, 0.01);
    EXPECT_NEAR(fitted_variance({0, 0, 20}).value, 20, 1e-3);
}

TEST(BlurKernel, DerivativesAreThoseOfTheValue) {
    const EdgeKernel kernel{0.4, 0.7, 0.3, Eigen::Vector2d(0.6, 0.8)};
    const FittedVariance at = fitted_variance(kernel);
    constexpr double step = 1e-3;
    const auto slope = [&](double EdgeKernel::*part) {
        EdgeKernel more = kernel, less = kernel;
        more.*part += step, less.*part -= step;
        return (fitted_variance(more).value - fitted_variance(less).value) / (2 * step);
    };
    EXPECT_NEAR(at.by_disc, slope(&EdgeKernel::disc), 1e-3);
    EXPECT_NEAR(at.by_motion, slope(&EdgeKernel::motion), 1e-3);
    EXPECT_NEAR(at.by_gaussian, slope(&EdgeKernel::gaussian), 1e-3);
}

TEST(BlurKernel, GoesOnBelowZero) {
    // Noise makes readings negative; a bound would bias what is averaged over them.
    const FittedVariance at = fitted_variance({0, -0.05, 0.3});
    EXPECT_LT(at.value, 0.27);
    EXPECT_GT(at.value, 0.23);
    EXPECT_LT(fitted_variance({0, 0, -0.05}).value, -0.04);
}

}  // namespace
}  // namespace matchlight
