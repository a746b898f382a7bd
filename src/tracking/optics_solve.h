// Focus, aperture, shutter and softness of a clip, from how blurred the edges of its tags are.
#pragma once

#include <cstddef>
#include <vector>

#include "tracking/optics_readings.h"

namespace matchlight {

struct Estimate {
    double value = 0, sigma = 0;
};

struct OpticsSolution {
    Estimate softness_px2;  // variance of what blurs everywhere alike: pixels' resampling, codec, aberrations
    Estimate shutter2;      // square of exposure time over frame time; noise may make it negative
    /// Whether the clip shows that its lens is out of focus at some depths; without it the two below are not set.
    bool defocus_seen = false;
    double defocus_evidence = 0;  // how much log evidence that has over a lens that is sharp everywhere
    Estimate coc_scale;           // px·m
    std::vector<Estimate> focus;  // 1/m, one a frame
    // Learned from the clip, as standard deviations in px².
    double scatter_px2 = 0;     // of readings beyond their own errors
    double frame_px2 = 0;       // of softness from frame to frame
    double unevenness_px2 = 0;  // of softness over the plate
};

/// Maximum a posteriori of Student-t errors (Gauss–Newton, iteratively reweighted by tag) under a blur that is the sum
/// of softness, defocus c²/16 with c = coc_scale · |1/focus − 1/z| and motion (shutter · motion)²/12, each seen through
/// the fit of a Gaussian (fitted_variance). Softness may differ from place to place in the plate, and focus may move;
/// how much, and how widely readings scatter, is chosen by the evidence of the data (MacKay 1992, Bayesian
/// Interpolation). `tags` must not be empty. Deterministic.
OpticsSolution solve_optics(const std::vector<TagBlurReadings>& tags, std::size_t frames);

}  // namespace matchlight
