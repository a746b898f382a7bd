// What bloom is, whichever way it is computed: the Gaussians that bright light spreads over.
#pragma once

#include <cmath>
#include <vector>

#include "render/effects/bright_light.h"
#include "scene/effects.h"

namespace matchlight {

struct BloomGaussian {
    double sigma_px = 0;
    double weight = 0;  // all weights sum to 1
};

/// Each Gaussian is half as wide as the one before it, and all weigh the same: their sum falls off about as 1/r²
/// between the narrowest and the widest, as light that lenses and eyes scatter does (Spencer, Shirley, Zimmerman,
/// Greenberg 1995, "Physically-Based Glare Effects for Digital Images"). Widths are in frame heights: a shot blooms
/// alike at every resolution. Widest first.
inline std::vector<BloomGaussian> bloom_gaussians(const BloomSettings& settings, int frame_height_px) {
    constexpr int count = 5;  // down to a sixteenth of the widest, 5 pixels at 1080 lines: sharper is the light itself
    std::vector<BloomGaussian> gaussians;
    for (int k = 0; k < count; ++k) {
        gaussians.push_back({settings.radius * frame_height_px / std::exp2(k), 1.0 / count});
    }
    return gaussians;
}

/// The light that blooms. The classic model measures luminance and holds nothing back.
inline BrightPassSettings bloom_light(const BloomSettings& settings, double object_strength = 1) {
    const bool classic = settings.level == BloomLevel::classic;
    return {.threshold = settings.threshold,
            .knee = settings.knee,
            .firefly_safe = settings.firefly_safe && !classic,
            .object_strength = object_strength,
            .measure = classic ? BrightMeasure::luminance : BrightMeasure::largest_channel};
}

/// The classic model squeezes the picture into a square, and blurs it there and twice reduced, always over the same
/// number of texels: so the widest of its three Gaussians is as wide as the other levels' widest, of the frame's width
/// from side to side and of its height from top to bottom.
inline constexpr int classic_bloom_sizes[] = {512, 256, 64};
inline double classic_bloom_sigma_texels(const BloomSettings& settings) {
    return settings.radius * classic_bloom_sizes[2];
}

}  // namespace matchlight
