// The merge itself, a row at a time, so that its sums have one shape whatever the number of threads.
#include "calibration/hdr_merge.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibration/merge_setup.h"
#include "core/parallel.h"

namespace matchlight {
namespace {

/// Below this nobody sees that a step between exposures is off: two codes of 255 at mid-grey.
constexpr double harmless_ev = 0.05;

/// One channel of one pixel.
class PixelMerge {
public:
    explicit PixelMerge(const MergeSetup& setup) : setup_(setup) { samples_.reserve(setup.codes.size()); }

    void start(int channel) {
        channel_ = channel;
        samples_.clear();
    }
    bool empty() const { return samples_.empty(); }
    /// Photographs come in their order, the longest exposure first.
    void add(std::size_t shot, float code) { samples_.push_back({shot, setup_.table.light(code, channel_)}); }

    struct Result {
        double radiance = 0, sigma = 0;
        bool clipped = false;
    };
    Result result() const {
        if (samples_.empty()) {
            const double bound = setup_.weights.back().full_light(channel_) / setup_.exposures.back();
            return {bound, bound, true};
        }
        // The longest exposure first: of those that are not clipped it tells most.
        double radiance = samples_.front().light / exposure_of(samples_.front());
        double information = 0;
        // Weights need the light only roughly: the second round changes them little, a third would not.
        for (int round = 0; round < 2; ++round) {
            double sum = 0;
            information = 0;
            for (const Sample& sample : samples_) {
                const double exposure = exposure_of(sample);
                const double weight = weight_of(sample, static_cast<float>(radiance * exposure));
                sum += weight * exposure * sample.light;
                information += weight * exposure * exposure;
            }
            if (!(information > 0)) return shortest_alone();
            radiance = sum / information;
        }
        return {radiance, std::sqrt(1 / information), false};
    }

private:
    struct Sample {
        std::size_t shot;
        float light;
    };

    double exposure_of(const Sample& sample) const { return setup_.exposures[sample.shot]; }
    double weight_of(const Sample& sample, float expected_light) const {
        const MergeWeights& weights = setup_.weights[sample.shot];
        return exposure_of(sample) < exposure_of(samples_.front())
                   ? weights.weight_above_noise(expected_light, channel_)
                   : weights.weight(expected_light, channel_);
    }
    /// All samples are so close to full that none has weight: the shortest exposure is furthest from it.
    Result shortest_alone() const {
        const Sample& last = samples_.back();
        const double sigma = std::sqrt(setup_.weights[last.shot].variance(last.light, channel_));
        return {last.light / exposure_of(last), sigma / exposure_of(last), false};
    }

    const MergeSetup& setup_;
    int channel_ = 0;
    std::vector<Sample> samples_;
};

MergeSetup merge_setup(const ExposureSeries& series, const CodeTable& table, const NoiseModel& noise,
                       const FullCodes& full, const std::vector<double>& exposures) {
    MergeSetup setup{table, noise, full, {}, exposures, {}};
    const std::vector<double> gains = iso_gains(series);
    for (std::size_t i = 0; i < series.shots.size(); ++i) {
        setup.codes.push_back(&series.shots[i].code);
        setup.weights.emplace_back(noise, table, full, gains[i]);
    }
    return setup;
}

void merge_row(const MergeSetup& setup, const std::vector<Image8>& ghosts, int y, MergedPhotograph& merged) {
    PixelMerge pixel(setup);
    for (int x = 0; x < setup.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
            pixel.start(c);
            std::uint8_t flags = 0;
            for (std::size_t shot = 0; shot < setup.codes.size(); ++shot) {
                const float code = setup.codes[shot]->at(x, y, c);
                if (setup.clipped(code, c)) continue;
                if (!ghosts.empty() && ghosts[shot].at(x, y) != 0) {
                    flags |= merge_flag::ghost;
                    continue;
                }
                pixel.add(shot, code);
            }
            const bool none_agrees = pixel.empty();
            // A channel may be clipped in all that agree. Those that do not agree hold it all the same, and what they
            // show is nearer than the bound of the shortest exposure, which is none where that is not clipped.
            for (std::size_t shot = 0; none_agrees && shot < setup.codes.size(); ++shot) {
                const float code = setup.codes[shot]->at(x, y, c);
                if (!setup.clipped(code, c)) pixel.add(shot, code);
            }
            const PixelMerge::Result result = pixel.result();
            if (result.clipped) flags |= merge_flag::clipped;
            if (result.radiance < result.sigma) flags |= merge_flag::under_noise;
            merged.radiance.at(x, y, c) = static_cast<float>(result.radiance);
            merged.sigma.at(x, y, c) = static_cast<float>(result.sigma);
            merged.flags.at(x, y, c) = flags;
        }
    }
}

std::string pair_name(const ExposureSeries& series, std::size_t i) {
    return series.shots[i].path.string() + " and " + series.shots[i + 1].path.filename().string();
}

void warn_of_disagreement(const ExposureSeries& series, const std::vector<PairAgreement>& agreements,
                          Warnings& warnings) {
    for (std::size_t i = 0; i < agreements.size(); ++i) {
        const PairAgreement& pair = agreements[i];
        if (pair.samples == 0) continue;
        const RoundingRange range = nominal_rounding_ev(series.shots[i].record, series.shots[i + 1].record);
        const double off = pair.measured_ev - pair.recorded_ev;
        const double slack = std::max(harmless_ev, 3 * pair.measured_sigma_ev);
        if (off >= range.least - slack && off <= range.most + slack) continue;
        warnings.add(
            fmt::format("{}: their pixels are {:.2f} EV apart, their exposures {:.2f}: the exposures or the "
                        "response are wrong (--refine-exposures takes what the pixels say)",
                        pair_name(series, i), pair.measured_ev, pair.recorded_ev));
    }
}

std::vector<double> recorded_exposures(const ExposureSeries& series) {
    std::vector<double> exposures;
    for (const Photograph& shot : series.shots) exposures.push_back(shot.exposure);
    return exposures;
}

/// Exposures by the measured ratios, their geometric mean kept.
std::vector<double> refined(std::vector<double> exposures, const std::vector<PairAgreement>& agreements) {
    double shift_ev = 0, mean_ev = 0;
    for (std::size_t i = 0; i < agreements.size(); ++i) {
        if (agreements[i].samples > 0) shift_ev -= agreements[i].measured_ev - agreements[i].recorded_ev;
        exposures[i + 1] *= std::exp2(shift_ev);
        mean_ev += shift_ev;
    }
    for (double& exposure : exposures) exposure *= std::exp2(-mean_ev / static_cast<double>(exposures.size()));
    return exposures;
}

void count_flags(MergedPhotograph& merged) {
    for (std::size_t i = 0; i < merged.flags.samples().size(); i += 3) {
        std::uint8_t flags = 0;
        for (std::size_t c = 0; c < 3; ++c) flags |= merged.flags.samples()[i + c];
        merged.clipped_pixels += (flags & merge_flag::clipped) != 0;
        merged.under_noise_pixels += (flags & merge_flag::under_noise) != 0;
        merged.ghost_pixels += (flags & merge_flag::ghost) != 0;
    }
}

void warn_of_pixels(const ExposureSeries& series, const MergedPhotograph& merged, Warnings& warnings) {
    const std::int64_t pixels = static_cast<std::int64_t>(series.width()) * series.height();
    if (merged.clipped_pixels > 0) {
        warnings.add(
            fmt::format("{}: {} of {} pixels are clipped even in this shortest exposure; their radiance is a "
                        "lower bound",
                        series.shots.back().path.string(), merged.clipped_pixels, pixels));
    }
    // Noise alone lifts one pixel in some over its sigma.
    if (merged.under_noise_pixels > 0.8 * static_cast<double>(pixels)) {
        warnings.add(fmt::format("{}: hardly a pixel stands out of the noise even in this longest exposure",
                                 series.shots.front().path.string()));
    }
}

/// What is measured of a series on one grid of pixels.
void measure(const ExposureSeries& series, const CodeTable& table, MergedPhotograph& merged) {
    merged.exposures = recorded_exposures(series);
    merged.noise = estimate_noise(series, merged.exposures, table, merged.full);
    merged.agreements = pair_agreements(series, table, merged.full, merged.noise);
}

/// The series on the reference's grid, where a photograph has to be moved for that.
std::optional<ExposureSeries> aligned(const ExposureSeries& series, const CodeTable& table, Alignment align,
                                      MergedPhotograph& merged) {
    merged.motions.resize(series.shots.size());
    if (align == Alignment::off || series.shots.size() < 2) return std::nullopt;
    const MergeSetup setup =
        merge_setup(series, table, merged.noise, merged.full, refined(merged.exposures, merged.agreements));
    merged.motions = find_motions(setup, best_exposed(setup), align == Alignment::automatic);
    if (std::none_of(merged.motions.begin(), merged.motions.end(), [](const auto& m) { return m.has_value(); }))
        return std::nullopt;
    ExposureSeries moved = series;
    for (std::size_t i = 0; i < moved.shots.size(); ++i) {
        if (merged.motions[i])
            moved.shots[i].code = moved_codes(series.shots[i].code, *merged.motions[i], table, merged.full);
    }
    return moved;
}

/// Of a series whose photographs lie on one grid, its measures taken.
void merge_grid(const ExposureSeries& series, const CodeTable& table, const MergeOptions& options,
                MergedPhotograph& merged) {
    // By the measured steps, whichever the merge takes: small errors of each step add up over many, and would pass for
    // things that moved.
    const std::vector<double> measured = refined(merged.exposures, merged.agreements);
    if (options.refine_exposures) {
        merged.exposures = measured;
        merged.noise = estimate_noise(series, merged.exposures, table, merged.full);
    }
    const MergeSetup setup = merge_setup(series, table, merged.noise, merged.full, merged.exposures);
    merged.reference = best_exposed(setup);
    std::vector<Image8> ghosts;
    if (options.deghost && series.shots.size() > 1) {
        MergeSetup compared = setup;
        compared.exposures = measured;
        ghosts = ghost_masks(compared, merged.reference);
    }
    merged.radiance = ImageF(series.width(), series.height(), 3);
    merged.sigma = ImageF(series.width(), series.height(), 3);
    merged.flags = Image8(series.width(), series.height(), 3);
    parallel_for(series.height(), [&](int y) { merge_row(setup, ghosts, y, merged); });
    count_flags(merged);
}

}  // namespace

MergedPhotograph merge_exposures(const ExposureSeries& series, const Response& response, const MergeOptions& options,
                                 Warnings& warnings) {
    assert(!series.shots.empty());
    const Photograph& first = series.shots.front();
    // The finest of the files' steps: the table is exact for all of them where they are those of 8 and 16 bits.
    double code_step = first.code_step;
    for (const Photograph& shot : series.shots) code_step = std::min(code_step, shot.code_step);
    const CodeTable table(response, first.linear, code_step);

    MergedPhotograph merged;
    merged.full = full_codes(series, table);
    measure(series, table, merged);
    const std::optional<ExposureSeries> moved = aligned(series, table, options.align, merged);
    if (moved) measure(*moved, table, merged);
    if (!options.refine_exposures) warn_of_disagreement(series, merged.agreements, warnings);
    merge_grid(moved ? *moved : series, table, options, merged);
    warn_of_pixels(series, merged, warnings);
    return merged;
}

}  // namespace matchlight
