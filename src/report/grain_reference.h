// The double-precision reference of grain, pixel by pixel.
#pragma once

#include "core/image.h"
#include "render/effects/grain_noise.h"
#include "report/bright_reference.h"

namespace matchlight {

/// RGB noise of variance 1 over a region of the frame.
ImageD reference_grain_noise(const GrainModel& model, const Region& region);

struct GrainLight {
    double light = 0;  // of the pixel, plate-linear
    double plate = 0;  // the plate's own
    double kept = 0;   // share of it that is in `light`
};
/// Standard deviation of what is added to one channel of a pixel.
double reference_grain_deviation(const GrainModel& model, const GrainLight& pixel);

}  // namespace matchlight
