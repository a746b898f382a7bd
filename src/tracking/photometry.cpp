// Robust two-way fit of frame exposures and tag offsets.
#include "tracking/photometry.h"

#include <algorithm>
#include <cmath>
#include <compare>

namespace matchlight {

namespace {

/// A tag's paper-minus-ink, or its ink alone.
struct Surface {
    int tag = 0;
    bool ink = false;
    auto operator<=>(const Surface&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
};

struct LogReading {
    std::size_t frame = 0;
    Surface surface;
    double value = 0;     // natural log of reading over expectation
    double variance = 0;  // of `value`
};

struct TwoWayFit {
    std::vector<std::optional<double>> frames;
    std::vector<double> frame_sigma;
};

/// Middle of `values` by weight; between two, where they meet at exactly half. Those without weight count only where
/// none has any.
double weighted_median(std::vector<std::pair<double, double>> values) {
    if (std::ranges::any_of(values, [](const auto& value) { return value.second > 0; })) {
        std::erase_if(values, [](const auto& value) { return value.second <= 0; });
    } else {
        for (auto& [value, weight] : values) weight = 1;
    }
    std::ranges::sort(values);
    double total = 0;
    for (const auto& [value, weight] : values) total += weight;
    double below = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        below += values[i].second;
        if (below > 0.5 * total * (1 + 1e-9)) return values[i].first;
        if (below >= 0.5 * total * (1 - 1e-9) && i + 1 < values.size()) {
            return 0.5 * (values[i].first + values[i + 1].first);
        }
    }
    return values.empty() ? 0 : values.back().first;
}

/// Light on paper is never quite what a flat card would send: curl, gloss and cast light vary by about a percent.
constexpr double paper_variance = 0.01 * 0.01;
/// Gloss and veil make up much of the light of ink and change with the view.
constexpr double ink_variance = 0.08 * 0.08;

TwoWayFit fit_two_way(const std::vector<LogReading>& readings, std::size_t frame_count,
                      const std::map<int, CardExpectation>& expectations) {
    TwoWayFit fit;
    fit.frames.resize(frame_count);
    fit.frame_sigma.assign(frame_count, 0);
    if (readings.empty()) return fit;
    std::vector<double> frame(frame_count, 0);
    std::map<Surface, double> offset;

    // Where paper is never seen unclipped, ink has to set the scale too.
    const bool any_paper = std::ranges::any_of(readings, [](const LogReading& r) { return !r.surface.ink; });
    const auto anchor_weight = [&](const Surface& surface) {
        return surface.ink && any_paper ? 0.0 : expectations.at(surface.tag).weight;
    };
    // Start: offsets against the frame's weighted median, so that frames with different tags agree soon.
    std::vector<std::vector<std::pair<double, double>>> by_frame(frame_count);
    for (const LogReading& reading : readings) {
        by_frame[reading.frame].emplace_back(reading.value, anchor_weight(reading.surface));
    }
    for (std::size_t f = 0; f < frame_count; ++f) frame[f] = weighted_median(by_frame[f]);

    const auto robust_weight = [](double residual, double variance) {
        // Cauchy's: a tag in shadow is off by dozens of standard deviations and must lose its voice, not just pull no
        // harder than the others.
        constexpr double knee = 2;
        return 1 / (variance * (1 + residual * residual / (knee * knee * variance)));
    };
    constexpr int rounds = 60;
    for (int round = 0; round < rounds; ++round) {
        std::map<Surface, std::pair<double, double>> offset_sums;
        for (const LogReading& reading : readings) {
            const double estimate = reading.value - frame[reading.frame];
            const double weight = robust_weight(estimate - offset[reading.surface], reading.variance);
            offset_sums[reading.surface].first += weight * estimate;
            offset_sums[reading.surface].second += weight;
        }
        std::vector<std::pair<double, double>> medians;
        for (const auto& [surface, sums] : offset_sums) {
            offset[surface] = sums.first / sums.second;
            medians.emplace_back(offset[surface], anchor_weight(surface));
        }
        const double middle = weighted_median(medians);
        for (auto& [surface, value] : offset) value -= middle;
        std::vector<std::pair<double, double>> frame_sums(frame_count);
        for (const LogReading& reading : readings) {
            const double estimate = reading.value - offset[reading.surface];
            const double weight = robust_weight(estimate - frame[reading.frame], reading.variance);
            frame_sums[reading.frame].first += weight * estimate;
            frame_sums[reading.frame].second += weight;
        }
        for (std::size_t f = 0; f < frame_count; ++f) {
            if (frame_sums[f].second <= 0) continue;
            frame[f] = frame_sums[f].first / frame_sums[f].second;
            fit.frames[f] = frame[f];
            fit.frame_sigma[f] = 1 / std::sqrt(frame_sums[f].second);
        }
    }
    return fit;
}

/// Fills frames without a value between two that have one; beyond the first and last the nearest is held.
std::optional<double> interpolated(const std::vector<std::optional<double>>& values, std::size_t at) {
    if (values[at]) return values[at];
    std::optional<std::size_t> before, after;
    for (std::size_t i = at; i-- > 0 && !before;) {
        if (values[i]) before = i;
    }
    for (std::size_t i = at + 1; i < values.size() && !after; ++i) {
        if (values[i]) after = i;
    }
    if (!before && !after) return std::nullopt;
    if (!before) return values[*after];
    if (!after) return values[*before];
    const double t = static_cast<double>(at - *before) / static_cast<double>(*after - *before);
    return (1 - t) * *values[*before] + t * *values[*after];
}

}  // namespace

ClipPhotometry solve_photometry(const std::vector<std::vector<CardReading>>& readings,
                                const std::map<int, CardExpectation>& expectations, bool relative) {
    std::array<TwoWayFit, 3> fits;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<LogReading> logs;
        for (std::size_t f = 0; f < readings.size(); ++f) {
            for (const CardReading& reading : readings[f]) {
                const auto expected = expectations.find(reading.id);
                if (expected == expectations.end()) continue;
                const auto add = [&](const CardLight& read, double expected_light, bool ink) {
                    if (!read.usable || !(expected_light > 0)) return;
                    logs.push_back({f,
                                    {reading.id, ink},
                                    std::log(read.light / expected_light),
                                    read.relative_error * read.relative_error + (ink ? ink_variance : paper_variance)});
                };
                add(reading.difference[channel], expected->second.difference[channel], false);
                add(reading.ink[channel], expected->second.ink[channel], true);
            }
        }
        fits[channel] = fit_two_way(logs, readings.size(), expectations);
    }
    ClipPhotometry clip;
    clip.frames.resize(readings.size());
    // Where a channel was clipped, its ratio to green is taken from the frames around: white balance changes slowly.
    std::array<std::vector<std::optional<double>>, 3> ratio;
    for (const std::size_t channel : {0, 2}) {
        ratio[channel].resize(readings.size());
        for (std::size_t f = 0; f < readings.size(); ++f) {
            if (fits[channel].frames[f] && fits[1].frames[f]) {
                ratio[channel][f] = *fits[channel].frames[f] - *fits[1].frames[f];
            }
        }
        const bool ever = std::ranges::any_of(ratio[channel], [](const auto& value) { return value.has_value(); });
        clip.white_balance_known = clip.white_balance_known && ever;
    }
    std::optional<double> reference;
    for (std::size_t f = 0; f < readings.size(); ++f) {
        const std::optional<double> green = interpolated(fits[1].frames, f);
        if (!green) continue;
        if (!reference) reference = relative ? *green : 0;
        FramePhotometry photometry;
        photometry.exposure_ev = (*green - *reference) / std::log(2.0);
        photometry.white_balance = {std::exp(interpolated(ratio[0], f).value_or(0)), 1,
                                    std::exp(interpolated(ratio[2], f).value_or(0))};
        const bool measured = fits[1].frames[f].has_value();
        const bool balanced = ratio[0][f] && ratio[2][f];
        // Certain while the exposure's own error is small against what is seen, 3 % of light or 0.04 EV.
        constexpr double visible_error = 0.03;
        const double error = fits[1].frame_sigma[f] / visible_error;
        photometry.confidence = (measured ? 1 / (1 + error * error) : 0.2) * (balanced || !measured ? 1 : 0.7);
        clip.frames[f] = photometry;
    }
    return clip;
}

}  // namespace matchlight
