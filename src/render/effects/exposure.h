// Exposure control: from what a meter read in each frame to how each frame is exposed (Reinhard et al. 2002,
// "Photographic tone reproduction for digital images").
#pragma once

#include <optional>
#include <vector>

#include "core/image.h"
#include "scene/effects.h"

namespace matchlight {

/// What the meter saw in one frame. Light is scene-linear luminance; absent where nothing was bright enough to meter.
struct MeterReading {
    std::optional<double> log2_average;  // trimmed mean of log₂ L
    std::optional<double> log2_maximum;
};

/// Luminance at or below this is black, and does not count: it would pull a mean of logarithms down without end. Far
/// below any light that a scene is lit by.
inline constexpr double black_luminance = 0x1p-40;

/// A meter's map: Σ log₂ L and the number of its pixels, and their greatest log₂ L, one texel a block; see
/// render/effects/exposure_meter.h. `darkest_share` and `brightest_share` of the pixels that are not black are left out
/// of the average, block by block in the order of their means. Summed in one order whatever the threads.
MeterReading read_meter(const ImageF& map, const ExposureSettings& settings);

/// One step of adaptation on log luminance: E += (T − E)(1 − exp(−dt/τ)), the exact solution for a target that holds
/// still, for any dt ≥ 0; τ by the direction it goes.
double adapted(double log2_now, double log2_target, double dt_s, const ExposureSettings& settings);

/// Exposures of a clip, in order of time: adapted to the first frame that the meter could read, then following with the
/// frames' true time stamps; frames that are black hold what was. The log average is placed at the key, and
/// white is the adapted maximum, so that a light that enters the frame does not pop; but no less than 1, where the tone
/// curve is the identity (deviation: below it the curve would stretch contrast until an even grey wall is white).
std::vector<FrameExposure> exposures_of_clip(const std::vector<MeterReading>& readings,
                                             const std::vector<double>& times_s, const ExposureSettings& settings);

/// What the tone curve (equation 4) multiplies light of that luminance by; 1 where `white` is 0, for no curve. As
/// shaders/effects/exposure/tone_curve.glsl.
double tone_factor(double luminance, double white);

}  // namespace matchlight
