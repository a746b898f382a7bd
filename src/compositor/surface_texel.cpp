// Median first, then the mean of what lies within its noise.
#include "compositor/surface_texel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/median.h"

namespace matchlight {

namespace {

/// Beyond three deviations a sample shows something else: of those that belong 1 in 370 is lost.
constexpr double most_deviations = 3;
/// Half of the weight is no majority yet, and three fifths are one.
constexpr double no_majority = 0.4, majority = 0.6;

/// What most frames say of a channel, clipped ones by their bounds.
struct Said {
    double value = 0;
    bool clipped = false;
};

Said weighted_median(std::vector<std::pair<double, const SurfaceSample*>>& values, std::size_t channel) {
    std::ranges::sort(values, {}, &std::pair<double, const SurfaceSample*>::first);
    double total = 0, below = 0;
    for (const auto& value : values) total += value.second->weight;
    for (const auto& [value, sample] : values) {
        below += sample->weight;
        if (2 * below >= total) return {value, sample->clipped[channel]};
    }
    return {values.back().first, values.back().second->clipped[channel]};
}

/// Where the median is a bound, the light is what unclipped frames say that do not lie below it; if there are none, the
/// bound. At least one sample.
Said light_of(std::span<const SurfaceSample> samples, std::size_t channel) {
    std::vector<std::pair<double, const SurfaceSample*>> values;
    for (const SurfaceSample& sample : samples) values.emplace_back(sample.radiance[channel], &sample);
    const Said median = weighted_median(values, channel);
    if (!median.clipped) return median;
    std::erase_if(values, [&](const auto& value) {
        const SurfaceSample& sample = *value.second;
        return sample.clipped[channel] || value.first < median.value - most_deviations * sample.deviation[channel];
    });
    return values.empty() ? median : weighted_median(values, channel);
}

/// A usual deviation, so that samples which are less sure than that (at the edge of a hand, say) count less.
double usual_deviation(std::span<const SurfaceSample> samples, std::size_t channel) {
    std::vector<double> deviations;
    for (const SurfaceSample& sample : samples) deviations.push_back(sample.deviation[channel]);
    return upper_median_in_place(deviations);
}

bool agrees(const SurfaceSample& sample, const std::array<Said, 3>& light) {
    for (std::size_t c = 0; c < 3; ++c) {
        const double beyond = sample.radiance[c] - light[c].value;
        const bool bound_holds = sample.clipped[c] && (beyond < 0 || light[c].clipped);
        if (!bound_holds && std::abs(beyond) > most_deviations * sample.deviation[c]) return false;
    }
    return true;
}

}  // namespace

SurfaceTexel agreed_texel(std::span<const SurfaceSample> samples) {
    if (samples.empty()) return {};
    const std::array<Said, 3> light{light_of(samples, 0), light_of(samples, 1), light_of(samples, 2)};
    const std::array<double, 3> usual{usual_deviation(samples, 0), usual_deviation(samples, 1),
                                      usual_deviation(samples, 2)};
    double total = 0, agreed = 0;
    std::array<double, 3> sum{}, weight{}, bound{};
    for (const SurfaceSample& sample : samples) {
        total += sample.weight;
        if (!agrees(sample, light)) continue;
        agreed += sample.weight;
        for (std::size_t c = 0; c < 3; ++c) {
            if (sample.clipped[c]) {
                bound[c] = std::max(bound[c], sample.radiance[c]);
            } else {
                constexpr double not_zero = std::numeric_limits<double>::min();
                const double sureness = usual[c] / std::max({sample.deviation[c], usual[c], not_zero});
                const double counts = sample.weight * sureness * sureness;
                sum[c] += counts * sample.radiance[c];
                weight[c] += counts;
            }
        }
    }
    SurfaceTexel texel;
    for (std::size_t c = 0; c < 3; ++c) {
        texel.clipped = texel.clipped || light[c].clipped;
        const bool has_mean = weight[c] > 0 && !light[c].clipped;
        texel.radiance[c] = std::max(has_mean ? sum[c] / weight[c] : std::max(light[c].value, bound[c]), 0.0);
    }
    const double t = std::clamp((agreed / total - no_majority) / (majority - no_majority), 0.0, 1.0);
    texel.knowledge = t * t * (3 - 2 * t);
    return texel;
}

}  // namespace matchlight
