// Two exposures of one scene against each other: their true ratio, and the noise that keeps them from agreeing.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calibration/code_table.h"
#include "calibration/exposure_series.h"

namespace matchlight {

/// Variance of the light that one photograph says, in units of its code 1:
///     variance(L) = read²·g² + shot·g·L + (gain·L)² + (slope·step)²·(1/12 + code²),
/// g the photograph's ISO over that of the series' first, slope that of the curve where it turns codes into light. 1/12
/// is rounding; `code` holds what compression and the camera's own filters do to codes, in steps of them, `gain` all
/// that grows with the light: pixels that are not alike, exposure times and a response that are a little off, edges
/// that moved.
struct NoiseModel {
    double read = 0;
    double shot = 0;
    double gain = 0;
    double code = 0;

    /// `rounding`: slope · step.
    double variance(double light, double iso_gain, double rounding) const {
        return read * read * iso_gain * iso_gain + shot * iso_gain * light + gain * gain * light * light +
               rounding * rounding * (1.0 / 12 + code * code);
    }
};

/// Each photograph's ISO over that of the first, 1 where it is not known.
std::vector<double> iso_gains(const ExposureSeries& series);

/// How two neighbours of a series agree.
struct PairAgreement {
    std::size_t samples = 0;       // pixels that both expose well, of those looked at
    double measured_ev = 0;        // log2 of the brighter photograph's exposure over the darker one's
    double measured_sigma_ev = 0;  // 0 samples: nothing measured
    double recorded_ev = 0;        // the same, by the exposures given
};

/// From which code on a channel of a series may be full: 1, or less where a camera ends before or where compression
/// carries full pixels below it.
using FullCodes = std::array<float, 3>;
/// What pixels show that by the next shorter exposure are brighter than full.
FullCodes full_codes(const ExposureSeries& series, const CodeTable& table);

/// The ratio of exposures of neighbours, in the series' order: a ratio of sums over pixels that both expose well,
/// within three deviations of the median, so that what moved does not count. `noise` says what stands out of it.
std::vector<PairAgreement> pair_agreements(const ExposureSeries& series, const CodeTable& table, const FullCodes& full,
                                           const NoiseModel& noise);

/// How far the ratio may lie from the recorded one because makers engrave rounded numbers: 1/30 s is made as 1/32,
/// f/22 as f/22.6. From `least` to `most`, in EV to add to the recorded ratio.
struct RoundingRange {
    double least = 0, most = 0;
};
RoundingRange nominal_rounding_ev(const ExposureRecord& brighter, const ExposureRecord& darker);

/// Fits the model to what neighbours differ by; of a photograph alone, to what neighbouring pixels differ by, which
/// texture makes larger. `exposures`: in the series' order.
NoiseModel estimate_noise(const ExposureSeries& series, const std::vector<double>& exposures, const CodeTable& table,
                          const FullCodes& full);

}  // namespace matchlight
