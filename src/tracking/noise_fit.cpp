// A line through variances whose errors are in proportion to themselves.
#include "tracking/noise_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/median.h"

namespace matchlight {

namespace {

struct Line {
    double at_zero = 0, slope = 0;
    double at(double signal) const { return at_zero + slope * signal; }
};

/// Weighted least squares with both coefficients held to zero or more.
Line non_negative_line(double s0, double s1, double s2, double t0, double t1) {
    const double determinant = s0 * s2 - s1 * s1;
    if (determinant > 0) {
        const Line line{(s2 * t0 - s1 * t1) / determinant, (s0 * t1 - s1 * t0) / determinant};
        if (line.at_zero >= 0 && line.slope >= 0) return line;
        if (line.at_zero < 0) return {0, std::max(0.0, t1 / s2)};
    }
    return {std::max(0.0, t0 / s0), 0};
}

/// The samples of half an octave of light each, as the median of their variances: dirt and edges, which only add, count
/// as single samples there, and paper weighs no more than ink.
std::vector<NoiseSample> levels_of(const std::vector<NoiseSample>& samples) {
    struct Level {
        std::vector<double> signals, ratios;
        double freedom = 0;
    };
    std::map<int, Level> levels;
    for (const NoiseSample& sample : samples) {
        constexpr double levels_per_octave = 2;
        Level& level = levels[static_cast<int>(std::floor(levels_per_octave * std::log2(sample.signal)))];
        level.signals.push_back(sample.signal);
        level.ratios.push_back(sample.variance / sample.signal);
        level.freedom += sample.freedom;
    }
    double freedom = 0;
    for (const auto& [index, level] : levels) freedom += level.freedom;
    std::vector<NoiseSample> medians;
    for (auto& [index, level] : levels) {
        constexpr double least_share = 0.005;  // the fringe of a level next to it
        if (level.freedom < least_share * freedom) continue;
        const double signal = upper_median(std::move(level.signals));
        medians.push_back({signal, signal * upper_median(std::move(level.ratios)), level.freedom});
    }
    return medians;
}

/// Variance of a surface's own texture, relative to its light squared. A sensor's noise is independent from channel to
/// channel, the grain of paper is the same in all of them; nothing is told where neighbours share chroma.
double texture_variance(const std::array<double, 3>& shared, const std::array<double, 3>& relative_slope,
                        bool chroma_shared) {
    if (chroma_shared) return 0;
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += shared[c] * relative_slope[c] * relative_slope[(c + 1) % 3];
    return std::max(0.0, sum / 3);
}

void add_samples(const std::array<CardCode, 3>& cards, const std::array<double, 3>& shared, const CardReading& reading,
                 const PlateLight& plate_light, std::vector<NoiseSample>& samples) {
    const auto within = [](const CardCode& card) {
        constexpr double reach = 2.5;  // standard deviations
        return card.noise_freedom > 0 && !card.clipped && card.code + reach * card.noise <= 1 &&
               card.code - reach * card.noise >= 0;
    };
    std::array<double, 3> light{}, slope{}, relative_slope{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](double code) {
            return plate_light.light_from_code(static_cast<float>(code), static_cast<int>(c));
        };
        const double step = std::max(cards[c].noise, 1e-3);
        light[c] = at(cards[c].code);
        slope[c] = (at(cards[c].code + step) - at(cards[c].code - step)) / (2 * step);
        relative_slope[c] = light[c] > 0 ? slope[c] / light[c] : 0;
    }
    const bool all_within = std::ranges::all_of(cards, within);
    const double texture = all_within ? texture_variance(shared, relative_slope, reading.chroma_shared) : 0;
    for (std::size_t c = 0; c < 3; ++c) {
        if (!within(cards[c]) || !(light[c] > 0)) continue;
        // Sheppard's correction (1898), and a floor so that a flat patch is noise of a small part of a step.
        const double rounding = reading.code_step * reading.code_step / 12;
        const double seen = std::max(cards[c].noise * cards[c].noise - rounding, 0.1 * rounding) * slope[c] * slope[c];
        samples.push_back({light[c], std::max(seen - texture * light[c] * light[c], 0.1 * seen),
                           static_cast<double>(cards[c].noise_freedom)});
    }
}

}  // namespace

std::vector<NoiseSample> noise_samples(const std::vector<std::vector<CardReading>>& readings,
                                       const PlateLight& plate_light) {
    std::vector<NoiseSample> samples;
    for (const auto& frame : readings) {
        for (const CardReading& reading : frame) {
            add_samples(reading.paper_code, reading.paper_shared, reading, plate_light, samples);
            add_samples(reading.ink_code, reading.ink_shared, reading, plate_light, samples);
        }
    }
    return samples;
}

std::optional<NoiseFit> fit_noise(const std::vector<NoiseSample>& samples) {
    constexpr std::size_t fewest = 6;
    if (samples.size() < fewest) return std::nullopt;
    const auto [darkest, brightest] = std::ranges::minmax_element(samples, {}, &NoiseSample::signal);
    constexpr double least_span = 4;
    if (!(brightest->signal > least_span * darkest->signal)) return std::nullopt;

    const std::vector<NoiseSample> levels = levels_of(samples);
    // Start: all shot noise, as it is in the middle.
    std::vector<double> ratios;
    for (const NoiseSample& level : levels) ratios.push_back(level.variance / level.signal);
    Line line{0, upper_median(std::move(ratios))};
    // Levels part from a line by about this beyond their counting error: grain of paper, coding, curves.
    constexpr double model_error = 0.2;
    constexpr int rounds = 60;
    for (int round = 0; round < rounds; ++round) {
        double s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
        for (const NoiseSample& level : levels) {
            // Errors are in proportion to the variance: between what is expected and what is seen, which of the two
            // leads to the middle of the ratios rather than to the lower or the higher ones.
            const double scale2 = std::max(line.at(level.signal), 1e-14) * std::max(level.variance, 1e-14);
            const double weight = 1 / ((2 / level.freedom + model_error * model_error) * scale2);
            s0 += weight;
            s1 += weight * level.signal;
            s2 += weight * level.signal * level.signal;
            t0 += weight * level.variance;
            t1 += weight * level.variance * level.signal;
        }
        line = non_negative_line(s0, s1, s2, t0, t1);
    }
    if (!(line.at(brightest->signal) > 0)) return std::nullopt;
    std::vector<double> apart;
    for (const NoiseSample& level : levels) {
        apart.push_back(std::abs(std::sqrt(level.variance / std::max(line.at(level.signal), 1e-14)) - 1));
    }
    return NoiseFit{std::sqrt(line.at_zero), line.slope, 0, upper_median(std::move(apart))};
}

std::optional<NoiseFit> fit_noise(const std::vector<std::vector<CardReading>>& readings,
                                  const PlateLight& plate_light) {
    std::optional<NoiseFit> fit = fit_noise(noise_samples(readings, plate_light));
    if (!fit) return fit;
    double sum = 0, weights = 0;
    for (const auto& frame : readings) {
        for (const CardReading& reading : frame) {
            // Green is nearest to luma: the other channels share chroma with their neighbours.
            for (const CardCode* card : {&reading.paper_code[1], &reading.ink_code[1]}) {
                if (card->clipped) continue;
                sum += card->noise_freedom * card->neighbour_correlation;
                weights += card->noise_freedom;
            }
        }
    }
    if (weights > 0) fit->neighbour_correlation = sum / weights;
    return fit;
}

}  // namespace matchlight
