// Families, how they predict pixels left out, and the choice between them.
#include "calibration/response_fit.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calibration/response_curve.h"
#include "core/median.h"

namespace matchlight {
namespace {

/// A pixel's code in one exposure and in the next shorter one.
struct CodePair {
    float longer, shorter;
    double ratio;  // of exposures, shorter over longer
    int channel, part;
};

enum class Share { fitted, held_out, all };

/// Chosen by the longer exposure, whose noise is the lesser, so that the noise of the shorter one chooses nothing.
std::vector<CodePair> code_pairs(const ResponseSamples& samples, Share share) {
    std::vector<CodePair> pairs;
    for (std::size_t place = 0; place < samples.places(); ++place) {
        if (share != Share::all && samples.held_out(place) != (share == Share::held_out)) continue;
        for (std::size_t j = 0; j + 1 < samples.photographs(); ++j) {
            const double ratio = std::exp(samples.log_exposure(j + 1) - samples.log_exposure(j));
            for (int channel = 0; channel < 3; ++channel) {
                if (!samples.usable(place, j, channel) || !samples.usable(place, j + 1, channel)) continue;
                pairs.push_back({samples.code(place, j, channel), samples.code(place, j + 1, channel), ratio, channel,
                                 samples.part(place)});
            }
        }
    }
    return pairs;
}

/// Squared difference of codes, held at a twentieth of full: more is something that moved.
double squared_error(const Response& response, const CodePair& pair) {
    constexpr double most = 0.05;
    const double light = std::max(response.linear_from_code(pair.longer, pair.channel), 0.0);
    const double predicted = std::clamp(response.code_from_linear(light * pair.ratio, pair.channel), 0.0, 1.0);
    const double error = std::min(std::abs(predicted - pair.shorter), most);
    return error * error;
}

double mean_square(const Response& response, const std::vector<CodePair>& pairs) {
    double sum = 0;
    for (const CodePair& pair : pairs) sum += squared_error(response, pair);
    return sum / static_cast<double>(std::max<std::size_t>(pairs.size(), 1));
}

Response fit_gamma(const std::vector<CodePair>& pairs) {
    std::array<double, 3> exponents{};
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<CodePair> own;
        std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(own),
                     [channel](const CodePair& pair) { return pair.channel == channel; });
        // Golden section between exponents beyond any camera's; the error has one valley between them.
        double low = 0.3, high = 5;
        const double golden = (std::sqrt(5.0) - 1) / 2;
        const auto error = [&own](double exponent) { return mean_square(Response::gamma(exponent), own); };
        double a = high - golden * (high - low), b = low + golden * (high - low);
        double error_a = error(a), error_b = error(b);
        while (high - low > 1e-4) {
            if (error_a < error_b) {
                high = std::exchange(b, a);
                error_b = error_a;
                a = high - golden * (high - low);
                error_a = error(a);
            } else {
                low = std::exchange(a, b);
                error_a = error_b;
                b = low + golden * (high - low);
                error_b = error(b);
            }
        }
        exponents[static_cast<std::size_t>(channel)] = 0.5 * (low + high);
    }
    return Response::gamma(exponents);
}

/// Channels' scales against one another are free: equal codes in the middle are taken for equal light, as Debevec &
/// Malik do. Then code 1 is light 1 on the channels' geometric mean.
Response response_of_curves(const std::array<LogCurve, 3>& curves, const std::filesystem::path& reported) {
    constexpr std::size_t middle = curve_nodes / 2;
    double top = 0;
    for (const LogCurve& curve : curves) top += (curve.back() - curve[middle]) / 3;
    std::array<std::vector<double>, 3> light;
    for (std::size_t c = 0; c < 3; ++c) {
        for (const double value : curves[c]) light[c].push_back(std::exp(value - curves[c][middle] - top));
    }
    return Response::table(std::move(light), reported);
}

struct Candidate {
    ResponseMethod method;
    Response from_half, from_all;
};

/// Each candidate's squared error against the best one's, over the parts of the picture.
std::vector<ResponseScore> scores_of(const std::vector<Candidate>& candidates, const std::vector<CodePair>& held_out,
                                     double code_step) {
    constexpr std::size_t parts = ResponseSamples::part_count;
    std::vector<std::array<double, parts>> sums(candidates.size(), std::array<double, parts>{});
    std::array<double, parts> counts{};
    for (const CodePair& pair : held_out) counts[static_cast<std::size_t>(pair.part)] += 1;
    std::vector<ResponseScore> scores;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        for (const CodePair& pair : held_out)
            sums[k][static_cast<std::size_t>(pair.part)] += squared_error(candidates[k].from_half, pair);
        scores.push_back({.method = candidates[k].method,
                          .held_out_codes = std::sqrt(mean_square(candidates[k].from_half, held_out))});
    }
    const auto best = static_cast<std::size_t>(
        std::min_element(scores.begin(), scores.end(),
                         [](const auto& a, const auto& b) { return a.held_out_codes < b.held_out_codes; }) -
        scores.begin());
    const auto total = static_cast<double>(held_out.size());
    bool chosen = false;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        ResponseScore& score = scores[k];
        score.excess =
            score.held_out_codes * score.held_out_codes - scores[best].held_out_codes * scores[best].held_out_codes;
        // Standard error of a ratio of sums over parts of unequal size (Cochran 1977, 6.4).
        double squares = 0;
        for (std::size_t part = 0; part < parts; ++part) {
            const double off = sums[k][part] - sums[best][part] - score.excess * counts[part];
            squares += off * off;
        }
        score.excess_error = std::sqrt(squares * parts / (parts - 1)) / total;
        // One standard error (Breiman et al. 1984), or a quarter of a code, which no file can hold.
        const double negligible = code_step * code_step / 16;
        score.chosen = !chosen && score.excess <= std::max(score.excess_error, negligible);
        chosen = chosen || score.chosen;
    }
    return scores;
}

using EquationsOf = CurveEquations (*)(const ResponseSamples&, int, const std::vector<double>&, Places);
using ChannelEquations = std::array<CurveEquations, 3>;

Response smooth_response(const ChannelEquations& equations, double smoothness, const std::filesystem::path& reported) {
    std::array<LogCurve, 3> curves;
    for (std::size_t c = 0; c < 3; ++c) curves[c] = smooth_curve(equations[c], smoothness);
    return response_of_curves(curves, reported);
}

/// The smoothest curve that predicts the pixels left out as well as any. The smoothest, because equal steps between
/// exposures leave open what repeats with the step along the logarithm of light (Grossberg & Nayar, "What can be Known
/// about the Radiometric Response from Images?", 2002): no pixel contradicts such waves.
Candidate curve_candidate(ResponseMethod method, const ResponseSamples& samples,
                          const std::filesystem::path& reported) {
    const EquationsOf equations_of = method == ResponseMethod::debevec ? debevec_equations : robertson_equations;
    ChannelEquations of_half, of_all;
    for (int channel = 0; channel < 3; ++channel) {
        const std::vector<double> weights = place_weights(samples, channel);
        of_half[static_cast<std::size_t>(channel)] = equations_of(samples, channel, weights, Places::fitted);
        of_all[static_cast<std::size_t>(channel)] = equations_of(samples, channel, weights, Places::all);
    }
    // From bends over more than the logarithm of all codes to some hundredths of it.
    std::vector<Candidate> candidates;
    for (const double smoothness : {1e3, 1e2, 1e1, 1.0, 1e-1, 1e-2, 1e-3, 1e-4}) {
        candidates.push_back(
            {method, smooth_response(of_half, smoothness, reported), smooth_response(of_all, smoothness, reported)});
    }
    const auto scores = scores_of(candidates, code_pairs(samples, Share::held_out), samples.code_step());
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        if (scores[k].chosen) return candidates[k];
    }
    return candidates.back();
}

Candidate candidate_of(ResponseMethod method, const ResponseSamples& samples, const std::filesystem::path& reported) {
    switch (method) {
        case ResponseMethod::gamma:
            return {method, fit_gamma(code_pairs(samples, Share::fitted)), fit_gamma(code_pairs(samples, Share::all))};
        case ResponseMethod::debevec:
        case ResponseMethod::robertson:
            return curve_candidate(method, samples, reported);
        case ResponseMethod::automatic:
        case ResponseMethod::srgb:
            break;
    }
    return {ResponseMethod::srgb, Response::srgb(), Response::srgb()};
}

std::vector<ResidualBin> residual_bins(const Response& response, const std::vector<CodePair>& pairs) {
    constexpr int bins = 32;
    constexpr std::size_t least_pixels = 20;
    std::array<std::array<std::vector<double>, 3>, bins> residuals;
    for (const CodePair& pair : pairs) {
        const double longer = response.linear_from_code(pair.longer, pair.channel) * pair.ratio;
        // Below, rounding and noise that ends at black say more than the curve.
        constexpr double least_code = 0.05;
        if (response.code_from_linear(std::max(longer, 0.0), pair.channel) < least_code) continue;
        const double shorter = response.linear_from_code(pair.shorter, pair.channel);
        if (!(longer > 0) || !(shorter > 0)) continue;
        const int bin = std::clamp(static_cast<int>(pair.longer * bins), 0, bins - 1);
        residuals[static_cast<std::size_t>(bin)][static_cast<std::size_t>(pair.channel)].push_back(
            std::log2(shorter / longer));
    }
    std::vector<ResidualBin> result;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        ResidualBin row;
        row.code = (static_cast<double>(bin) + 0.5) / bins;
        for (std::size_t c = 0; c < 3; ++c) {
            std::vector<double>& values = residuals[bin][c];
            row.mean_ev[c] = row.sigma_ev[c] = std::numeric_limits<double>::quiet_NaN();
            if (values.size() < least_pixels) continue;
            const double middle = upper_median_in_place(values);
            for (double& value : values) value = std::abs(value - middle);
            row.mean_ev[c] = middle;
            row.sigma_ev[c] = 1.4826 * upper_median_in_place(values);
        }
        result.push_back(row);
    }
    return result;
}

double root_mean_square_ev(const std::vector<ResidualBin>& residuals) {
    double sum = 0;
    int count = 0;
    for (const ResidualBin& bin : residuals) {
        for (const double mean : bin.mean_ev) {
            if (std::isnan(mean)) continue;
            sum += mean * mean;
            ++count;
        }
    }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

void warn_of_spans(const ExposureSeries& series, const ResponseFit& fit, Warnings& warnings) {
    const bool table = fit.method == ResponseMethod::debevec || fit.method == ResponseMethod::robertson;
    float least = 0, greatest = 1;
    for (const auto& span : fit.spans) {
        least = std::max(least, span.least);
        greatest = std::min(greatest, span.greatest);
    }
    // Beyond, every curve is carried on by its own course; a tenth of the codes of that is common and does no harm.
    if (!table || (least <= 0.1f && greatest >= 0.9f)) return;
    warnings.add(
        fmt::format("{}: the photographs tell the response from code {:.0f} to {:.0f} of 255 only; beyond, it is "
                    "carried on smoothly",
                    series.shots.front().path.string(), least * 255, greatest * 255));
}

}  // namespace

std::string name_of(ResponseMethod method) {
    switch (method) {
        case ResponseMethod::automatic:
            return "auto";
        case ResponseMethod::srgb:
            return "srgb";
        case ResponseMethod::gamma:
            return "gamma";
        case ResponseMethod::debevec:
            return "debevec";
        case ResponseMethod::robertson:
            return "robertson";
    }
    return {};
}

ResponseFit fit_response(const ExposureSeries& series, ResponseMethod method, Warnings& warnings) {
    const ResponseSamples samples(series);
    const std::filesystem::path& reported = series.shots.front().path;
    std::vector<Candidate> candidates;
    if (method == ResponseMethod::automatic) {
        // The simplest first.
        for (const ResponseMethod tried :
             {ResponseMethod::srgb, ResponseMethod::gamma, ResponseMethod::debevec, ResponseMethod::robertson})
            candidates.push_back(candidate_of(tried, samples, reported));
    } else {
        candidates.push_back(candidate_of(method, samples, reported));
    }
    ResponseFit fit;
    fit.scores = scores_of(candidates, code_pairs(samples, Share::held_out), samples.code_step());
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        if (!fit.scores[k].chosen) continue;
        fit.response = candidates[k].from_all;
        fit.method = candidates[k].method;
    }
    fit.residuals = residual_bins(fit.response, code_pairs(samples, Share::all));
    fit.residual_ev = root_mean_square_ev(fit.residuals);
    for (int channel = 0; channel < 3; ++channel) fit.spans[static_cast<std::size_t>(channel)] = samples.span(channel);
    fit.places = samples.places();
    warn_of_spans(series, fit, warnings);
    return fit;
}

}  // namespace matchlight
