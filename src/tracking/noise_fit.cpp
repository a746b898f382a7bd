// A line through variances whose errors are in proportion to themselves.
#include "tracking/noise_fit.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tracking/robust_plane.h"

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
    std::vector<NoiseSample> medians;
    for (auto& [index, level] : levels) {
        const double signal = upper_median(std::move(level.signals));
        medians.push_back({signal, signal * upper_median(std::move(level.ratios)), level.freedom});
    }
    return medians;
}

}  // namespace

std::vector<NoiseSample> noise_samples(const std::vector<std::vector<CardReading>>& readings,
                                       const PlateLight& plate_light) {
    std::vector<NoiseSample> samples;
    for (const auto& frame : readings) {
        for (const CardReading& reading : frame) {
            for (std::size_t channel = 0; channel < 3; ++channel) {
                for (const CardCode* card : {&reading.paper_code[channel], &reading.ink_code[channel]}) {
                    constexpr double reach = 2.5;  // standard deviations
                    if (card->noise_freedom == 0 || card->clipped) continue;
                    if (card->code + reach * card->noise > 1 || card->code - reach * card->noise < 0) continue;
                    const auto light = [&](double code) {
                        return plate_light.light_from_code(static_cast<float>(code), static_cast<int>(channel));
                    };
                    const double step = std::max(card->noise, 1e-3);
                    const double slope = (light(card->code + step) - light(card->code - step)) / (2 * step);
                    // Sheppard's correction (1898), and a floor so that a flat patch is noise of a small part of a
                    // step.
                    const double rounding = reading.code_step * reading.code_step / 12;
                    const double noise = std::max(card->noise * card->noise - rounding, 0.1 * rounding);
                    samples.push_back(
                        {light(card->code), slope * slope * noise, static_cast<double>(card->noise_freedom)});
                }
            }
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
