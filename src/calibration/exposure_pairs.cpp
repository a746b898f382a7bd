// Statistics of pixels that two photographs share.
#include "calibration/exposure_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

#include "core/median.h"

namespace matchlight {
namespace {

/// Pixels of a pair that are looked at: enough for a median to a thousandth of a deviation.
constexpr int most_pixels = 400'000;
constexpr double mad_to_sigma = 1.4826;  // of a normal distribution

/// A pixel's light by two photographs, each in units of its own code 1.
struct SharedLight {
    double brighter, darker;
    double brighter_rounding, darker_rounding;  // a code's step as light
};

int stride_of(const ExposureSeries& series) {
    const double pixels = static_cast<double>(series.width()) * series.height();
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / most_pixels))));
}

/// Codes that tell light well: away from black, where rounding and offsets rule, and from full, where curves bend.
struct CodeRange {
    float least, most;  // of full
};

std::vector<SharedLight> shared_light(const ExposureSeries& series, std::size_t i, int channel, const CodeTable& table,
                                      const FullCodes& full, CodeRange brighter_range, CodeRange darker_range) {
    const Photograph& brighter = series.shots[i];
    const Photograph& darker = series.shots[i + 1];
    const float top = full[static_cast<std::size_t>(channel)];
    const auto within = [top](float code, CodeRange range) {
        return code >= range.least * top && code <= range.most * top;
    };
    const int stride = stride_of(series);
    std::vector<SharedLight> shared;
    for (int y = stride / 2; y < series.height(); y += stride) {
        for (int x = stride / 2; x < series.width(); x += stride) {
            const float a = brighter.code.at(x, y, channel), b = darker.code.at(x, y, channel);
            if (!within(a, brighter_range) || !within(b, darker_range)) continue;
            shared.push_back({table.light(a, channel), table.light(b, channel),
                              table.slope(a, channel) * table.code_step(),
                              table.slope(b, channel) * table.code_step()});
        }
    }
    return shared;
}

/// Light of the darker photograph over that of the brighter one.
struct MeasuredRatio {
    std::size_t samples = 0;
    double log2_ratio = 0, sigma = 0;
};

MeasuredRatio measured_ratio(const std::vector<SharedLight>& shared) {
    // Fewer could be one small thing that moved.
    constexpr std::size_t least_samples = 200;
    MeasuredRatio measured;
    if (shared.size() < least_samples) return measured;
    // Noise is symmetric in the noisier one's light, not in its logarithm.
    std::vector<double> ratios;
    ratios.reserve(shared.size());
    for (const SharedLight& light : shared) ratios.push_back(light.darker / light.brighter);
    const double middle = upper_median(ratios);
    std::vector<double> distances;
    distances.reserve(ratios.size());
    for (const double value : ratios) distances.push_back(std::abs(value - middle));
    const double sigma = std::max(mad_to_sigma * upper_median(distances), 1e-6 * middle);
    double brighter = 0, darker = 0;
    for (std::size_t i = 0; i < shared.size(); ++i) {
        if (distances[i] > 3 * sigma) continue;
        brighter += shared[i].brighter;
        darker += shared[i].darker;
        ++measured.samples;
    }
    if (!(darker > 0)) return {};
    measured.log2_ratio = std::log2(brighter / darker);
    // Neighbouring pixels of a JPEG's block err together: count its 64 as one.
    measured.sigma =
        sigma / middle / std::numbers::ln2 / std::sqrt(std::max(1.0, static_cast<double>(measured.samples) / 64));
    return measured;
}

/// log2 of the nearest value that makers mean by an engraved one: their scales run in thirds or halves of a stop.
double meant_ev(double engraved_ev) {
    const double third = std::round(engraved_ev * 3) / 3, half = std::round(engraved_ev * 2) / 2;
    return std::abs(third - engraved_ev) < std::abs(half - engraved_ev) ? third : half;
}

/// Mean squared difference of a group of pixels of like light, against what the model's terms add to it.
struct NoiseBin {
    Eigen::Vector4d terms;  // coefficients of read², shot, gain², code²
    double rounding = 0;    // what rounding alone gives
    double observed = 0;
    double light = 0;
};

struct Difference {
    double light;  // of the darker photograph
    double value;
    double rounding;  // variance
};

/// Second moment about 0, each value held within three robust deviations of the median, so that things that moved
/// count as noise of ordinary size.
double winsorised_moment(const std::vector<Difference>& differences) {
    std::vector<double> values;
    double rounding = 0;
    for (const Difference& difference : differences) {
        values.push_back(difference.value);
        rounding += difference.rounding;
    }
    rounding /= static_cast<double>(differences.size());
    const double middle = upper_median(values);
    std::vector<double> distances;
    for (const double value : values) distances.push_back(std::abs(value - middle));
    // Differences of few codes have a median distance of 0.
    const double reach = 3 * std::max(mad_to_sigma * upper_median(distances), std::sqrt(rounding));
    double sum = 0;
    for (const double value : values) {
        const double held = std::clamp(value, middle - reach, middle + reach);
        sum += held * held;
    }
    return sum / static_cast<double>(values.size());
}

/// Groups by light, eight to a factor of ten; a few hundred pixels give a variance to a tenth. `ratio`: of exposures,
/// darker over brighter; 0 where the differences are those of one photograph.
void add_bins(std::vector<Difference> differences, double ratio, double darker_gain, double brighter_gain,
              std::vector<NoiseBin>& bins) {
    constexpr std::size_t least_in_bin = 200;
    std::sort(differences.begin(), differences.end(), [](const Difference& a, const Difference& b) {
        return a.light != b.light ? a.light < b.light : a.value < b.value;
    });
    for (std::size_t first = 0; first < differences.size();) {
        std::size_t last = first;
        const double end = std::max(differences[first].light * std::pow(10, 1.0 / 8), 1e-5);
        while (last < differences.size() && differences[last].light <= end) ++last;
        if (last - first >= least_in_bin) {
            const std::vector<Difference> group(differences.begin() + static_cast<std::ptrdiff_t>(first),
                                                differences.begin() + static_cast<std::ptrdiff_t>(last));
            double light = 0, rounding = 0;
            for (const Difference& difference : group) {
                light += difference.light;
                rounding += difference.rounding;
            }
            const auto count = static_cast<double>(group.size());
            light /= count;
            NoiseBin bin;
            bin.terms = {darker_gain * darker_gain + ratio * ratio * brighter_gain * brighter_gain,
                         light * (darker_gain + ratio * brighter_gain), (ratio > 0 ? 2 : 1) * light * light,
                         12 * rounding / count};
            bin.rounding = rounding / count;
            bin.observed = winsorised_moment(group);
            bin.light = light;
            bins.push_back(bin);
        }
        first = last;
    }
}

/// Negative noise ends at code 0, so bins whose light lies within two deviations of it show too little; where there are
/// no others, half of what there is (the second moment of a normal distribution cut off at its mean).
void allow_for_black(std::vector<NoiseBin>& bins) {
    const auto cut_off = [](const NoiseBin& bin) { return bin.light * bin.light < 4 * bin.observed; };
    if (std::all_of(bins.begin(), bins.end(), cut_off)) {
        for (NoiseBin& bin : bins) bin.observed *= 2;
    } else {
        bins.erase(std::remove_if(bins.begin(), bins.end(), cut_off), bins.end());
    }
}

/// The best of the sixteen ways to leave terms out, none negative (Lawson & Hanson 1974 for four unknowns): weighted
/// least squares, the weight of a bin by the variance that the model expects there.
Eigen::Vector4d fit_terms(const std::vector<NoiseBin>& bins) {
    Eigen::Vector4d best = Eigen::Vector4d::Zero();
    for (int pass = 0; pass < 3; ++pass) {
        double least = std::numeric_limits<double>::infinity();
        const Eigen::Vector4d before = best;
        for (int used = 0; used < 16; ++used) {
            Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
            Eigen::Vector4d right = Eigen::Vector4d::Zero();
            const auto weight_of = [&](const NoiseBin& bin) {
                const double expected = pass == 0 ? bin.observed : before.dot(bin.terms) + bin.rounding;
                return 1 / std::max(expected * expected, 1e-24);
            };
            for (const NoiseBin& bin : bins) {
                normal += weight_of(bin) * bin.terms * bin.terms.transpose();
                right += weight_of(bin) * bin.terms * (bin.observed - bin.rounding);
            }
            for (int k = 0; k < 4; ++k) {
                if ((used & (1 << k)) != 0) continue;
                normal.row(k).setZero();
                normal.col(k).setZero();
                normal(k, k) = 1;
                right[k] = 0;
            }
            const Eigen::Vector4d found = normal.fullPivLu().solve(right);
            if (!found.allFinite() || found.minCoeff() < 0) continue;
            double cost = 0;
            for (const NoiseBin& bin : bins) {
                const double off = bin.observed - bin.rounding - found.dot(bin.terms);
                cost += weight_of(bin) * off * off;
            }
            if (cost < least) {
                least = cost;
                best = found;
            }
        }
    }
    return best;
}

/// Differences of neighbouring pixels of one photograph, halved in variance: both carry noise.
std::vector<Difference> neighbour_differences(const Photograph& shot, int channel, const CodeTable& table, float top) {
    std::vector<Difference> differences;
    for (int y = 0; y < shot.code.height(); ++y) {
        for (int x = 1; x < shot.code.width(); x += 2) {
            const float a = shot.code.at(x - 1, y, channel), b = shot.code.at(x, y, channel);
            if (a >= top || b >= top) continue;
            const double rounding = table.slope(b, channel) * table.code_step();
            differences.push_back({0.5 * (table.light(a, channel) + table.light(b, channel)),
                                   (table.light(b, channel) - table.light(a, channel)) / std::sqrt(2.0),
                                   rounding * rounding / 12});
        }
    }
    return differences;
}

}  // namespace

std::vector<double> iso_gains(const ExposureSeries& series) {
    std::vector<double> gains;
    const double first = series.shots.front().record.iso;
    for (const Photograph& shot : series.shots) {
        gains.push_back(first > 0 && shot.record.iso > 0 ? shot.record.iso / first : 1);
    }
    return gains;
}

FullCodes full_codes(const ExposureSeries& series, const CodeTable& table) {
    FullCodes full = {1, 1, 1};
    // Well over full, by a photograph that is well below it: neither noise nor a curve that is a little off brings
    // other pixels in.
    constexpr float over = 1.3f, least_code = 0.3f, most_code = 0.9f;
    constexpr std::size_t least_pixels = 100;
    const int stride = stride_of(series);
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<float> codes;
        for (std::size_t i = 0; i + 1 < series.shots.size(); ++i) {
            const auto ratio = static_cast<float>(series.shots[i].exposure / series.shots[i + 1].exposure);
            for (int y = stride / 2; y < series.height(); y += stride) {
                for (int x = stride / 2; x < series.width(); x += stride) {
                    const float darker = series.shots[i + 1].code.at(x, y, channel);
                    if (darker < least_code || darker > most_code) continue;
                    if (table.light(darker, channel) * ratio < over * table.light(1, channel)) continue;
                    const float brighter = series.shots[i].code.at(x, y, channel);
                    if (brighter <= 1) codes.push_back(brighter);  // more is outside of a moved photograph
                }
            }
        }
        if (codes.size() < least_pixels) continue;
        const auto middle = codes.begin() + static_cast<std::ptrdiff_t>(codes.size() / 2);
        std::nth_element(codes.begin(), middle, codes.end());
        // Compression moves codes by some; what lies further below is something that moved.
        constexpr float most_moved = 0.04f;
        const float plateau = *middle;
        const auto low = codes.begin() + static_cast<std::ptrdiff_t>(codes.size() / 50);
        std::nth_element(codes.begin(), low, codes.end());
        // A plateau in the lower half is no camera's.
        if (plateau > 0.5f) full[static_cast<std::size_t>(channel)] = std::max(*low, plateau - most_moved);
    }
    return full;
}

std::vector<PairAgreement> pair_agreements(const ExposureSeries& series, const CodeTable& table, const FullCodes& full,
                                           const NoiseModel& noise) {
    // A response that is wrong shows as noise that grows with light; it must not keep the ratio from being told.
    NoiseModel sensor = noise;
    sensor.gain = 0;
    const std::vector<double> gains = iso_gains(series);
    std::vector<PairAgreement> agreements;
    for (std::size_t i = 0; i + 1 < series.shots.size(); ++i) {
        PairAgreement agreement;
        agreement.recorded_ev = std::log2(series.shots[i].exposure / series.shots[i + 1].exposure);
        const double ratio = std::exp2(-agreement.recorded_ev);
        std::vector<SharedLight> well_exposed;
        for (int channel = 0; channel < 3; ++channel) {
            // The longer exposure alone chooses, by the codes in which curves are told best, and where the shorter one
            // stands five deviations out of its noise: choosing by the noisier one's own codes would keep its
            // brighter pixels.
            for (const SharedLight& light : shared_light(series, i, channel, table, full, {0.3f, 0.9f}, {0, 0.95f})) {
                const double expected = ratio * light.brighter;
                if (expected * expected > 25 * sensor.variance(expected, gains[i + 1], light.darker_rounding))
                    well_exposed.push_back(light);
            }
        }
        const MeasuredRatio measured = measured_ratio(well_exposed);
        agreement.samples = measured.samples;
        agreement.measured_ev = measured.log2_ratio;
        agreement.measured_sigma_ev = measured.sigma;
        agreements.push_back(agreement);
    }
    return agreements;
}

RoundingRange nominal_rounding_ev(const ExposureRecord& brighter, const ExposureRecord& darker) {
    RoundingRange range;
    const auto add = [&range](double brighter_ev, double darker_ev) {
        if (brighter_ev == darker_ev) return;  // set once, whatever it really is
        const double off = (meant_ev(brighter_ev) - brighter_ev) - (meant_ev(darker_ev) - darker_ev);
        range.least += std::min(off, 0.0);
        range.most += std::max(off, 0.0);
    };
    add(std::log2(brighter.exposure_s), std::log2(darker.exposure_s));
    if (brighter.f_number > 0 && darker.f_number > 0)
        add(-2 * std::log2(brighter.f_number), -2 * std::log2(darker.f_number));
    if (brighter.iso > 0 && darker.iso > 0) add(std::log2(brighter.iso / 100), std::log2(darker.iso / 100));
    return range;
}

NoiseModel estimate_noise(const ExposureSeries& series, const std::vector<double>& exposures, const CodeTable& table,
                          const FullCodes& full) {
    const std::vector<double> gains = iso_gains(series);
    std::vector<NoiseBin> bins;
    for (std::size_t i = 0; i + 1 < series.shots.size(); ++i) {
        const double ratio = exposures[i + 1] / exposures[i];
        for (int channel = 0; channel < 3; ++channel) {
            std::vector<Difference> differences;
            // Chosen by the brighter one alone, whose noise is the lesser: choosing by the darker one's own value
            // would bias it.
            for (const SharedLight& light :
                 shared_light(series, i, channel, table, full, {0.02f, 0.96f}, {0, 0.999f})) {
                differences.push_back({ratio * light.brighter, light.darker - ratio * light.brighter,
                                       (light.darker_rounding * light.darker_rounding +
                                        ratio * ratio * light.brighter_rounding * light.brighter_rounding) /
                                           12});
            }
            add_bins(std::move(differences), ratio, gains[i + 1], gains[i], bins);
        }
    }
    if (bins.empty()) {
        for (int channel = 0; channel < 3; ++channel) {
            add_bins(
                neighbour_differences(series.shots.front(), channel, table, full[static_cast<std::size_t>(channel)]), 0,
                1, 0, bins);
        }
    }
    allow_for_black(bins);
    const Eigen::Vector4d terms = fit_terms(bins);
    return {std::sqrt(terms[0]), terms[1], std::sqrt(terms[2]), std::sqrt(terms[3])};
}

}  // namespace matchlight
