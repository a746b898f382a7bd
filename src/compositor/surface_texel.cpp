// Median first, then the mean of what lies within its noise.
#include "compositor/surface_texel.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace matchlight {

namespace {

using Channels = std::array<double, 3>;

/// Beyond three deviations a sample shows something else: of those that belong 1 in 370 is lost.
constexpr double most_deviations = 3;
/// Half of the weight is no majority yet, and three fifths are one.
constexpr double no_majority = 0.4, majority = 0.6;

bool is_known(const SurfaceSample& sample, std::size_t channel, bool bounds_count) {
    return bounds_count || !sample.clipped[channel];
}

std::optional<double> weighted_median(std::span<const SurfaceSample> samples, std::size_t channel, bool bounds_count) {
    std::vector<std::pair<double, double>> values;  // with their weights
    double total = 0;
    for (const SurfaceSample& sample : samples) {
        if (!is_known(sample, channel, bounds_count)) continue;
        values.emplace_back(sample.radiance[channel], sample.weight);
        total += sample.weight;
    }
    if (values.empty()) return std::nullopt;
    std::ranges::sort(values);
    double below = 0;
    for (const auto& [value, weight] : values) {
        below += weight;
        if (2 * below >= total) return value;
    }
    return values.back().first;
}

struct Agreement {
    SurfaceTexel texel;
    double share = 0;
};

Agreement agreement(std::span<const SurfaceSample> samples, bool bounds_count) {
    std::array<std::optional<double>, 3> median;
    for (std::size_t c = 0; c < 3; ++c) median[c] = weighted_median(samples, c, bounds_count);
    const auto agrees = [&](const SurfaceSample& sample) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (!median[c]) continue;
            const double beyond = sample.radiance[c] - *median[c];
            const bool below_bound = !is_known(sample, c, bounds_count) && beyond < 0;
            if (!below_bound && std::abs(beyond) > most_deviations * sample.deviation[c]) return false;
        }
        return true;
    };
    double total = 0, agreed = 0;
    Channels sum{}, weight{}, bound{};
    Agreement result;
    for (const SurfaceSample& sample : samples) {
        total += sample.weight;
        if (!agrees(sample)) continue;
        agreed += sample.weight;
        for (std::size_t c = 0; c < 3; ++c) {
            if (sample.clipped[c]) bound[c] = std::max(bound[c], sample.radiance[c]);
            if (!is_known(sample, c, bounds_count)) continue;
            result.texel.clipped = result.texel.clipped || sample.clipped[c];
            sum[c] += sample.weight * sample.radiance[c];
            weight[c] += sample.weight;
        }
    }
    result.share = agreed / total;
    for (std::size_t c = 0; c < 3; ++c) {
        if (weight[c] > 0) {
            result.texel.radiance[c] = std::max(sum[c] / weight[c], 0.0);
        } else {
            result.texel.clipped = result.texel.clipped || !median[c];
            result.texel.radiance[c] = median[c].value_or(bound[c]);
        }
    }
    const double t = std::clamp((result.share - no_majority) / (majority - no_majority), 0.0, 1.0);
    result.texel.knowledge = t * t * (3 - 2 * t);
    return result;
}

}  // namespace

SurfaceTexel agreed_texel(std::span<const SurfaceSample> samples) {
    if (samples.empty()) return {};
    const Agreement unclipped = agreement(samples, false);
    // Where most frames clip and the rest say less than their bound, the rest saw something else.
    if (unclipped.share >= majority) return unclipped.texel;
    const Agreement bounded = agreement(samples, true);
    return bounded.share > unclipped.share ? bounded.texel : unclipped.texel;
}

}  // namespace matchlight
