// Bracketed photographs merged into one picture of radiance that says how sure each pixel is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/exposure_pairs.h"
#include "calibration/exposure_series.h"
#include "calibration/merge_alignment.h"
#include "calibration/response.h"
#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

enum class Alignment { automatic, on, off };

struct MergeOptions {
    Alignment align = Alignment::automatic;  // automatic: only where a photograph is seen to have moved
    bool deghost = true;                     // leave a photograph out where it shows something else
    bool refine_exposures = false;           // take the ratios of exposures that the pixels tell
};

/// What may be said of a channel of a pixel (MergedPhotograph::flags).
namespace merge_flag {
inline constexpr std::uint8_t clipped = 1;      // in every photograph: radiance is a lower bound
inline constexpr std::uint8_t under_noise = 2;  // radiance is less than its sigma
inline constexpr std::uint8_t ghost = 4;        // a photograph was left out for showing something else
}  // namespace merge_flag

struct MergedPhotograph {
    ImageF radiance;  // RGB; light that gives code 1 at exposure E is 1/E
    ImageF sigma;     // RGB, of radiance, in its units; that of a lower bound is the bound itself
    Image8 flags;     // a channel each for R, G and B, of merge_flag

    std::vector<double> exposures;  // that were used, in the series' order
    std::size_t reference = 0;      // the photograph that decides where others disagree
    std::vector<PairAgreement> agreements;
    std::vector<std::optional<PhotographMotion>> motions;  // of photographs that were moved
    NoiseModel noise;
    FullCodes full = {1, 1, 1};
    std::int64_t clipped_pixels = 0, under_noise_pixels = 0, ghost_pixels = 0;  // in any channel
};

/// Maximum likelihood under the noise model that the series itself shows: weights by inverse variance of each
/// photograph's light as the merged radiance predicts it (so that a sample's own noise does not weigh it), 0 at full
/// code and fading towards it. Warns of exposures that pixels contradict and of pixels clipped in every photograph.
MergedPhotograph merge_exposures(const ExposureSeries& series, const Response& response, const MergeOptions& options,
                                 Warnings& warnings);

}  // namespace matchlight
