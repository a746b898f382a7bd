// One-parameter families of curves, judged by the constancy of ratios.
#include "tracking/response_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "core/median.h"

namespace matchlight {

namespace {

struct CodePair {
    double paper = 0, ink = 0;  // codes
    double paper_error = 0, ink_error = 0;
    double weight = 1;  // shares of one independent observation
};

/// Pairs of one tag in one channel: their ratio of light is one number.
using Groups = std::map<std::pair<int, std::size_t>, std::vector<CodePair>>;

/// Gloss and veil on the ink change with the view by a few percent of its light.
constexpr double view_sigma = 0.03;

/// d log(light) / d code.
double relative_slope(const Response& response, double code, int channel) {
    constexpr double step = 1e-3;
    return (std::log(response.linear_from_code(code + step, channel)) -
            std::log(response.linear_from_code(code - step, channel))) /
           (2 * step);
}

struct Observed {
    Groups groups;
    double independent = 0;
    double range_ev = 0;
};

Observed gather(const std::vector<std::vector<CardReading>>& readings) {
    Observed observed;
    std::map<std::pair<int, std::size_t>, std::map<int, int>> counts;
    const Response srgb = Response::srgb();
    // The exposure as sRGB has it is good enough to tell which readings repeat each other.
    const auto exposure_bin = [&](double code) {
        constexpr double bins_per_ev = 10;
        return static_cast<int>(std::floor(bins_per_ev * std::log2(srgb.linear_from_code(code, 1))));
    };
    std::map<std::pair<int, std::size_t>, std::pair<double, double>> ranges;
    const auto visit = [&](const auto& action) {
        for (const auto& frame : readings) {
            for (const CardReading& reading : frame) {
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    const CardCode &paper = reading.paper_code[channel], &ink = reading.ink_code[channel];
                    // Nearer to black a code is mostly rounding.
                    constexpr double fewest_steps = 8;
                    if (paper.clipped || ink.clipped || ink.code < fewest_steps * reading.code_step) continue;
                    if (!(paper.code > ink.code)) continue;
                    action(std::pair{reading.id, channel}, paper, ink, reading.code_step);
                }
            }
        }
    };
    visit([&](const auto& key, const CardCode& paper, const CardCode&, double) {
        ++counts[key][exposure_bin(paper.code)];
    });
    visit([&](const auto& key, const CardCode& paper, const CardCode& ink, double step) {
        // Coding in blocks rounds means to a good part of a step, however many pixels they have. The view's error is
        // kept in codes, too (by sRGB's slope, near enough): errors that were fixed in light would favour whichever
        // curve makes all ratios small.
        const double coding = 0.25 * step;
        const double view = view_sigma / relative_slope(srgb, ink.code, 1);
        observed.groups[key].push_back({paper.code, ink.code, std::hypot(paper.standard_error, coding),
                                        std::hypot(ink.standard_error, coding, view),
                                        1.0 / counts[key][exposure_bin(paper.code)]});
        const double ev = std::log2(srgb.linear_from_code(paper.code, 1));
        const auto [range, first] = ranges.try_emplace(key, ev, ev);
        range->second.first = std::min(range->second.first, ev);
        range->second.second = std::max(range->second.second, ev);
    });
    for (const auto& [key, bins] : counts) observed.independent += static_cast<double>(bins.size());
    for (const auto& [key, range] : ranges) {
        observed.range_ev = std::max(observed.range_ev, range.second - range.first);
    }
    return observed;
}

struct LogRatio {
    double value = 0, variance = 0, weight = 0;
};

LogRatio log_ratio(const Response& response, const CodePair& pair, std::size_t channel) {
    const int c = static_cast<int>(channel);
    return {std::log(response.linear_from_code(pair.paper, c) / response.linear_from_code(pair.ink, c)),
            std::pow(relative_slope(response, pair.paper, c) * pair.paper_error, 2) +
                std::pow(relative_slope(response, pair.ink, c) * pair.ink_error, 2),
            pair.weight};
}

struct Misfit {
    double ratios = 0;   // χ² (Cauchy's where it is large) of ratios about their groups' own values
    double albedos = 0;  // of those values about the albedos'
};

Misfit misfit(const Response& response, const Observed& observed, double log_albedo_ratio) {
    Misfit cost;
    std::vector<double> levels;
    for (const auto& [key, pairs] : observed.groups) {
        std::vector<LogRatio> ratios;
        std::vector<double> values;
        for (const CodePair& pair : pairs) {
            ratios.push_back(log_ratio(response, pair, key.second));
            values.push_back(ratios.back().value);
        }
        constexpr double knee2 = 9;  // three standard deviations
        double level = upper_median(std::move(values));
        constexpr int rounds = 8;
        for (int round = 0; round < rounds; ++round) {
            double sum = 0, weights = 0;
            for (const LogRatio& ratio : ratios) {
                const double residual = ratio.value - level;
                const double weight = ratio.weight / (ratio.variance + residual * residual / knee2);
                sum += weight * ratio.value;
                weights += weight;
            }
            level = sum / weights;
        }
        for (const LogRatio& ratio : ratios) {
            const double residual = ratio.value - level;
            cost.ratios += ratio.weight * knee2 * std::log1p(residual * residual / (knee2 * ratio.variance));
        }
        levels.push_back(level);
    }
    // Gloss adds up to a fifth to the light of ink; prints differ by a tenth. All tags are printed alike: counted once.
    constexpr double usual_gloss = 0.07, ratio_sigma = 0.12;
    const double apart = (upper_median(std::move(levels)) - (log_albedo_ratio - usual_gloss)) / ratio_sigma;
    cost.albedos = apart * apart;
    return cost;
}

/// The least of a function over [low, high]: the best of a grid, then golden sections about it.
double least_at(const std::function<double(double)>& function, double low, double high) {
    constexpr int grid = 24;
    double best = low, best_value = function(low);
    const double step = (high - low) / grid;
    for (int i = 1; i <= grid; ++i) {
        const double value = function(low + i * step);
        if (value >= best_value) continue;
        best = low + i * step;
        best_value = value;
    }
    double from = std::max(low, best - step), to = std::min(high, best + step);
    constexpr double golden = 0.6180339887498949;
    constexpr int sections = 18;
    for (int i = 0; i < sections; ++i) {
        const double left = to - golden * (to - from), right = from + golden * (to - from);
        if (function(left) < function(right)) {
            to = right;
        } else {
            from = left;
        }
    }
    return 0.5 * (from + to);
}

}  // namespace

ResponseFit fit_response(const std::vector<std::vector<CardReading>>& readings, double paper_over_ink) {
    ResponseFit fit;
    const Observed observed = gather(readings);
    fit.exposure_range_ev = observed.range_ev;
    // Over half a stop sRGB and a plain exponent part by a few percent of the ratio, which is what views change it by.
    constexpr double least_range_ev = 0.5, fewest_independent = 8;
    if (observed.range_ev < least_range_ev || observed.independent < fewest_independent) return fit;
    fit.told = true;
    const double log_ratio_expected = std::log(paper_over_ink);
    const auto shouldered = [](double knee) { return Response::shoulder({.knee = knee}, "response"); };
    // Errors as they turn out: where even the best curve leaves more than what was assumed, all weigh less.
    double inflation = 1;
    const auto cost_of = [&](const Response& response) {
        const Misfit cost = misfit(response, observed, log_ratio_expected);
        return cost.ratios / inflation + cost.albedos;
    };
    const auto candidates = [&] {
        const double exponent = least_at([&](double gamma) { return cost_of(Response::gamma(gamma)); }, 1.0, 3.2);
        const double knee = least_at([&](double k) { return cost_of(shouldered(k)); }, 0.05, 0.95);
        return std::array{Response::gamma(exponent), shouldered(knee)};
    };
    double least_ratios = misfit(fit.response, observed, log_ratio_expected).ratios;
    for (const Response& candidate : candidates()) {
        least_ratios = std::min(least_ratios, misfit(candidate, observed, log_ratio_expected).ratios);
    }
    const double freedom = std::max(1.0, observed.independent - static_cast<double>(observed.groups.size()) - 1);
    inflation = std::max(1.0, least_ratios / freedom);

    const double penalty = std::log(observed.independent);
    const double srgb_cost = cost_of(fit.response);
    double best_cost = srgb_cost;
    for (const Response& candidate : candidates()) {
        const double cost = cost_of(candidate) + penalty;
        fit.gain_over_srgb = std::max(fit.gain_over_srgb, srgb_cost - cost);
        // "Strong" in the words of Kass & Raftery (1995): sRGB is left only for that.
        constexpr double strong = 6;
        if (cost >= best_cost || srgb_cost - cost < strong) continue;
        best_cost = cost;
        fit.response = candidate;
    }
    return fit;
}

}  // namespace matchlight
