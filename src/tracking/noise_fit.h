// The footage's noise against its light, from the even parts of the tags.
#pragma once

#include <optional>
#include <vector>

#include "tracking/grey_card.h"
#include "tracking/plate_light.h"

namespace matchlight {

struct NoiseSample {
    double signal = 0;    // plate-linear
    double variance = 0;  // of one pixel, plate-linear
    double freedom = 0;   // degrees of freedom behind it
};

struct NoiseFit {
    double read = 0, shot = 0;         // variance = read² + shot · signal
    double neighbour_correlation = 0;  // of horizontal neighbours; 0: white
    double relative_error = 0;         // how far standard deviations are from the model, typically
};

/// Paper and ink of every reading and channel, without those near black or white, where clipping takes from the noise.
/// What rounding to codes adds is taken off, and so is the surface's own texture where the channels are coded each for
/// itself.
std::vector<NoiseSample> noise_samples(const std::vector<std::vector<CardReading>>& readings,
                                       const PlateLight& plate_light);

/// Read and shot noise by relative least squares through the medians of levels, neither below zero. nullopt where the
/// samples are too few, or span less than a factor of four of light, which does not tell the two apart.
std::optional<NoiseFit> fit_noise(const std::vector<NoiseSample>& samples);

/// Both, with the correlation of neighbours over all readings.
std::optional<NoiseFit> fit_noise(const std::vector<std::vector<CardReading>>& readings, const PlateLight& plate_light);

}  // namespace matchlight
