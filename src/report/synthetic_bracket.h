// Bracketed photographs of known radiance by a known camera: the reference that merging and responses are held against.
#pragma once

#include <cstdint>
#include <vector>

#include "calibration/exposure_series.h"
#include "calibration/response.h"
#include "core/image.h"

namespace matchlight {

/// Code = response(light + noise), held to 0..1 and rounded. Light is radiance · exposure.
struct SyntheticCamera {
    Response response = Response::srgb();
    double read_noise = 0.001, shot_noise = 0.0004;  // variance = read² + shot · light
    int code_steps = 255;
    double full_code = 1;  // where the camera ends
    unsigned seed = 1;
};

/// What that camera takes; exposures in any order, the series in its own. Each photograph's noise depends on its
/// exposure and the seed alone.
ExposureSeries photographed(const ImageF& radiance, const std::vector<double>& exposures,
                            const SyntheticCamera& camera);

/// A scene whose light runs evenly over `range_ev` stops from left to right, 1 at its brightest, with three colours.
ImageF radiance_ramp(int width, int height, double range_ev);

}  // namespace matchlight
