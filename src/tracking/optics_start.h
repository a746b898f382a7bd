// A first estimate of focus, aperture and shutter, from which the solve converges.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tracking/optics_readings.h"

namespace matchlight {

struct OpticsStart {
    double softness_px2 = 0;
    double coc_scale = 0;       // px·m
    double shutter2 = 0;        // fraction of the frame time, squared
    std::vector<double> focus;  // 1/m, one a frame
};

/// Blur does not tell the side of the focus it lies on, so from every scale of a coarse grid the best path of focus
/// over the clip is taken (Viterbi), alternating with least squares for the rest; the kernels' variances are taken as
/// they are. nullopt where blur does not grow away from any depth.
std::optional<OpticsStart> find_optics_start(const std::vector<TagBlurReadings>& tags, std::size_t frames);

}  // namespace matchlight
