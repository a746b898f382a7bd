// From readings to exposures: expectations, the joint fit, its scale, and frames without paper.
#include "tracking/photometry.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "tracking/light_gradient.h"

namespace matchlight {

namespace {

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

std::vector<LogReading> log_readings(const std::vector<std::vector<CardReading>>& readings,
                                     const std::map<int, CardExpectation>& expectations) {
    std::vector<LogReading> logs;
    for (std::size_t f = 0; f < readings.size(); ++f) {
        for (const CardReading& reading : readings[f]) {
            const auto expected = expectations.find(reading.id);
            if (expected == expectations.end()) continue;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const auto add = [&](const CardLight& read, double expected_light, bool ink) {
                    if (!read.usable || !(expected_light > 0)) return;
                    logs.push_back(
                        {.frame = f,
                         .channel = channel,
                         .surface = {reading.id, ink},
                         .value = std::log(read.light / expected_light),
                         .variance = read.relative_error * read.relative_error + (ink ? ink_variance : paper_variance),
                         .radius = reading.radius});
                };
                add(reading.difference[channel], expected->second.difference[channel], false);
                add(reading.ink[channel], expected->second.ink[channel], true);
            }
        }
    }
    return logs;
}

/// Where paper is seen unclipped, by channel and frame, and whether a channel ever has any.
struct PaperSeen {
    std::array<std::vector<char>, 3> in_frame;
    std::array<bool, 3> ever{};

    PaperSeen(const std::vector<LogReading>& logs, std::size_t frame_count) {
        for (auto& frames : in_frame) frames.assign(frame_count, 0);
        for (const LogReading& log : logs) {
            if (log.surface.ink) continue;
            in_frame[log.channel][log.frame] = 1;
            ever[log.channel] = true;
        }
    }
};

/// Frames whose paper is clipped hang on ink, whose offset drifts with gloss and coding. There the drift is taken from
/// the frames around that show both, so that exposure meets theirs without a step.
void tie_ink(const std::vector<LogReading>& logs, const PaperSeen& paper, LightFit& fit) {
    const auto fall_off = [&](double radius) {
        if (!fit.vignette) return 0.0;
        const double r2 = radius * radius;
        return std::log(1 + fit.vignette->gain[0] * r2 + fit.vignette->gain[1] * r2 * r2);
    };
    std::map<std::pair<CardSurface, std::size_t>, std::vector<std::pair<std::size_t, double>>> drift;
    for (const LogReading& log : logs) {
        if (!log.surface.ink || !paper.in_frame[log.channel][log.frame]) continue;
        const double residual = log.value - *fit.exposure[log.channel][log.frame] -
                                fit.offset[log.channel].at(log.surface) - fall_off(log.radius);
        drift[{log.surface, log.channel}].emplace_back(log.frame, residual);
    }
    // Half a second or so: gloss changes as the camera moves, coding as the exposure does.
    constexpr double near_frames = 8;
    const auto drift_at = [&](const LogReading& log) {
        const auto known = drift.find({log.surface, log.channel});
        double sum = 0, weights = 0.05;  // far from any frame with both, the offset of the whole clip stands
        if (known == drift.end()) return 0.0;
        for (const auto& [frame, residual] : known->second) {
            const double away = (static_cast<double>(frame) - static_cast<double>(log.frame)) / near_frames;
            const double clipped = std::clamp(residual, -2 * std::sqrt(ink_variance), 2 * std::sqrt(ink_variance));
            const double weight = std::exp(-std::abs(away));
            sum += weight * clipped;
            weights += weight;
        }
        return sum / weights;
    };
    std::map<std::pair<std::size_t, std::size_t>, std::vector<std::pair<double, double>>> estimates;
    for (const LogReading& log : logs) {
        if (!log.surface.ink || paper.in_frame[log.channel][log.frame]) continue;
        const double estimate =
            log.value - fit.offset[log.channel].at(log.surface) - fall_off(log.radius) - drift_at(log);
        estimates[{log.frame, log.channel}].emplace_back(estimate, 1 / log.variance);
    }
    for (auto& [place, values] : estimates)
        fit.exposure[place.second][place.first] = weighted_median(std::move(values));
}

/// The offsets' scale: takes an even gradient from them, then what makes their weighted median zero.
std::optional<Eigen::Vector3d> set_scale(const std::map<int, CardExpectation>& expectations, LightFit& fit) {
    // Where paper is never seen unclipped, ink has to set the scale too.
    const auto paper_only = [](const LightFit::Surfaces& offsets) {
        return std::ranges::any_of(offsets, [](const auto& offset) { return !offset.first.ink; });
    };
    std::vector<TagLight> lights;
    for (const auto& [tag, expected] : expectations) {
        double sum = 0;
        int channels = 0;
        for (const LightFit::Surfaces& offsets : fit.offset) {
            const auto paper = offsets.find({tag, false});
            if (paper == offsets.end()) continue;
            sum += paper->second;
            ++channels;
        }
        // A channel that is missing would change the mean of those that are there.
        if (channels == 3) lights.push_back({expected.place_m, sum / channels});
    }
    const std::optional<Eigen::Vector3d> gradient = fit_light_gradient(lights);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const bool paper = paper_only(fit.offset[channel]);
        std::vector<std::pair<double, double>> medians;
        for (const auto& [surface, offset] : fit.offset[channel]) {
            const CardExpectation& expected = expectations.at(surface.tag);
            double there = gradient ? gradient->dot(expected.place_m) : 0;
            if (expected.shown_difference && !surface.ink) {
                there = std::log((*expected.shown_difference)[channel] / expected.difference[channel]);
            }
            medians.emplace_back(offset - there, surface.ink && paper ? 0 : expected.weight);
        }
        const double middle = weighted_median(std::move(medians));
        for (std::optional<double>& exposure : fit.exposure[channel]) {
            if (exposure) *exposure += middle;
        }
    }
    if (!gradient) return std::nullopt;
    return *gradient / std::log(2.0);
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

/// Log light of one channel over green's, by frame, where paper shows both unclipped.
using Ratios = std::vector<std::optional<double>>;

/// Each frame's ratio as the mean of those around that do not differ by more than their own scatter: coding of chroma
/// shakes it from frame to frame, a camera's balance drifts over seconds or jumps (bilateral weights, Tomasi & Manduchi
/// 1998, with Cauchy's in value).
Ratios steadied(const Ratios& ratios) {
    std::vector<double> steps;
    std::optional<double> before;
    for (const std::optional<double>& ratio : ratios) {
        if (ratio && before) steps.push_back(std::abs(*ratio - *before));
        before = ratio;
    }
    if (steps.empty()) return ratios;
    // The difference of two has √2 of the scatter of one.
    const double scatter = 1.4826 * upper_median(std::move(steps)) / std::sqrt(2.0);
    if (!(scatter > 0)) return ratios;
    constexpr int reach = 12;  // frames: half a second at least
    Ratios steady(ratios.size());
    for (std::size_t f = 0; f < ratios.size(); ++f) {
        if (!ratios[f]) continue;
        const std::size_t from = f > reach ? f - reach : 0, to = std::min(ratios.size(), f + reach + 1);
        // The frame itself may be the one that is off: judged from the middle of its neighbours.
        std::vector<double> around;
        for (std::size_t g = f > 2 ? f - 2 : 0; g < std::min(ratios.size(), f + 3); ++g) {
            if (ratios[g]) around.push_back(*ratios[g]);
        }
        const double middle = upper_median(std::move(around));
        double sum = 0, weights = 0;
        for (std::size_t g = from; g < to; ++g) {
            if (!ratios[g]) continue;
            const double apart = (*ratios[g] - middle) / (3 * scatter);
            const double away = (static_cast<double>(g) - static_cast<double>(f)) / (0.5 * reach);
            const double weight = std::exp(-0.5 * away * away) / (1 + apart * apart);
            sum += weight * *ratios[g];
            weights += weight;
        }
        steady[f] = sum / weights;
    }
    return steady;
}

struct LogExposure {
    double log_exposure = 0, sigma = 0;
};

/// One exposure from the channels, each freed from the white balance and weighted by its share of luminance (ITU-R
/// BT.709): paper's where any channel has it, ink's otherwise.
std::vector<std::optional<LogExposure>> merged_channels(const LightFit& fit, const PaperSeen& paper,
                                                        const std::array<Ratios, 3>& balance) {
    constexpr std::array<double, 3> luminance{0.2126, 0.7152, 0.0722};
    const std::size_t frame_count = fit.exposure[0].size();
    std::vector<std::optional<LogExposure>> merged(frame_count);
    for (std::size_t f = 0; f < frame_count; ++f) {
        const bool any_paper = paper.in_frame[0][f] || paper.in_frame[1][f] || paper.in_frame[2][f];
        double sum = 0, weights = 0, sigmas = 0;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            if (!fit.exposure[channel][f] || !balance[channel][f]) continue;
            if (any_paper && !paper.in_frame[channel][f]) continue;
            sum += luminance[channel] * (*fit.exposure[channel][f] - *balance[channel][f]);
            sigmas += luminance[channel] * fit.exposure_sigma[channel][f];  // of the same pixels: not independent
            weights += luminance[channel];
        }
        if (weights > 0) merged[f] = {sum / weights, sigmas / weights};
    }
    return merged;
}

}  // namespace

ClipPhotometry solve_photometry(const std::vector<std::vector<CardReading>>& readings,
                                const std::map<int, CardExpectation>& expectations, bool relative) {
    const std::vector<LogReading> logs = log_readings(readings, expectations);
    const std::size_t frame_count = readings.size();
    LightFit fit = fit_light(logs, frame_count);
    const PaperSeen paper(logs, frame_count);
    tie_ink(logs, paper, fit);
    ClipPhotometry clip;
    clip.frames.resize(frame_count);
    clip.vignette = fit.vignette;
    clip.light_gradient_ev_per_m = set_scale(expectations, fit);

    // Where a channel was clipped, its ratio to green is taken from the frames around: white balance changes slowly.
    // Ink of one channel against paper of another would bring in the ink's gloss.
    std::array<Ratios, 3> seen_ratio, balance;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        seen_ratio[channel].resize(frame_count);
        const bool never = !paper.ever[channel] || !paper.ever[1];
        for (std::size_t f = 0; f < frame_count; ++f) {
            if (!fit.exposure[channel][f] || !fit.exposure[1][f]) continue;
            if (!never && !(paper.in_frame[channel][f] && paper.in_frame[1][f])) continue;
            seen_ratio[channel][f] = *fit.exposure[channel][f] - *fit.exposure[1][f];
        }
        const Ratios steady = steadied(seen_ratio[channel]);
        for (std::size_t f = 0; f < frame_count; ++f) balance[channel].push_back(interpolated(steady, f));
        clip.white_balance_known = clip.white_balance_known &&
                                   std::ranges::any_of(steady, [](const auto& value) { return value.has_value(); });
    }
    const auto merged = merged_channels(fit, paper, balance);
    std::vector<std::optional<double>> exposure(frame_count);
    for (std::size_t f = 0; f < frame_count; ++f) {
        if (merged[f]) exposure[f] = merged[f]->log_exposure;
    }
    std::optional<double> reference;
    for (std::size_t f = 0; f < frame_count; ++f) {
        const std::optional<double> log_exposure = interpolated(exposure, f);
        if (!log_exposure) continue;
        if (!reference) reference = relative ? *log_exposure : 0;
        FramePhotometry photometry;
        photometry.exposure_ev = (*log_exposure - *reference) / std::log(2.0);
        photometry.white_balance = {std::exp(balance[0][f].value_or(0)), 1, std::exp(balance[2][f].value_or(0))};
        photometry.measured = merged[f].has_value();
        const bool balanced = seen_ratio[0][f] && seen_ratio[2][f];
        constexpr double guessed = 0.2;  // from the frames around
        if (photometry.measured) {
            // Certain while the exposure's own error is small against what is seen, 3 % of light or 0.04 EV.
            constexpr double visible_error = 0.03;
            const double error = merged[f]->sigma / visible_error;
            photometry.confidence = std::max(guessed, 1 / (1 + error * error) * (balanced ? 1 : 0.7));
        } else {
            photometry.confidence = guessed;
        }
        clip.frames[f] = photometry;
    }
    return clip;
}

}  // namespace matchlight
