// Hash, quantiles and taps.
#include "render/effects/grain_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace matchlight {

namespace {

/// Where the standard normal distribution has `share` of itself below, for 0 < share <= 0.5.
double normal_quantile(double share) {
    const auto below = [](double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); };
    double low = -9, high = 0;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        (below(middle) < share ? low : high) = middle;
    }
    return (low + high) / 2;
}

/// Sampled Gaussian from its middle to one side, the middle at 1, as far as single precision sees it.
std::vector<double> sampled_gaussian(double sigma) {
    constexpr double cut_sigmas = 4;
    std::vector<double> weights{1};
    for (int i = 1; i <= static_cast<int>(std::ceil(cut_sigmas * sigma)); ++i) {
        weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    }
    return weights;
}

double sum_of_squares(const std::vector<double>& weights) {
    double sum = 0;
    for (const double weight : weights) sum += 2 * weight * weight;
    return sum - weights[0] * weights[0];
}

}  // namespace

std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v) {
    for (std::uint32_t& word : v) word = word * 1664525U + 1013904223U;
    const auto mix = [&] {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
    };
    mix();
    for (std::uint32_t& word : v) word ^= word >> 16U;
    mix();
    return v;
}

std::vector<float> grain_quantiles() {
    constexpr int count = 1 << grain_quantile_bits;
    std::vector<double> lower_half;
    double squares = 0;
    for (int i = 0; i < count / 2; ++i) {
        lower_half.push_back(normal_quantile((i + 0.5) / count));
        squares += 2 * lower_half.back() * lower_half.back();
    }
    const double scale = 1 / std::sqrt(squares / count);
    std::vector<float> values(count);
    for (std::size_t i = 0; i < lower_half.size(); ++i) {
        values[i] = static_cast<float>(scale * lower_half[i]);
        values[values.size() - 1 - i] = -values[i];
    }
    return values;
}

std::vector<float> grain_taps(double correlation_px) {
    if (correlation_px < least_grain_correlation_px) return {1};
    const std::vector<double> weights = sampled_gaussian(correlation_px);
    const double scale = 1 / std::sqrt(sum_of_squares(weights));
    std::vector<float> taps(weights.size());
    std::ranges::transform(weights, taps.begin(), [&](double weight) { return static_cast<float>(scale * weight); });
    return taps;
}

double grain_neighbour_correlation(double correlation_px) {
    if (correlation_px < least_grain_correlation_px) return 0;
    const std::vector<double> weights = sampled_gaussian(correlation_px);
    double products = 0;
    for (std::size_t i = 0; i + 1 < weights.size(); ++i) products += 2 * weights[i] * weights[i + 1];
    return products / sum_of_squares(weights);
}

double grain_correlation_px(double neighbour_correlation) {
    if (neighbour_correlation <= grain_neighbour_correlation(least_grain_correlation_px)) return 0;
    double low = least_grain_correlation_px, high = widest_grain_correlation_px;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        (grain_neighbour_correlation(middle) < neighbour_correlation ? low : high) = middle;
    }
    return high;
}

double GrainModel::largest_deviation() const {
    return strength * std::sqrt(read * read + shot * brightest);
}

double least_grain_deviation(const GrainModel& model, double light) {
    static const double largest_value = std::ranges::max(grain_quantiles());
    const std::vector<float> taps = grain_taps(model.correlation_px);
    double sum = taps[0];
    for (std::size_t i = 1; i < taps.size(); ++i) sum += 2 * taps[i];
    return light / (largest_value * sum * sum);
}

}  // namespace matchlight
