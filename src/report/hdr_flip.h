// HDR-FLIP: the difference that people see at any exposure, for pictures of light that no display holds at once.
//
// Andersson, Nilsson, Shirley, Akenine-Möller, "Visualizing and Communicating Errors in Rendered Images", Ray Tracing
// Gems II, chapter 19, 2021 (first as "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021).
#pragma once

#include "core/image.h"
#include "report/flip.h"

namespace matchlight {

/// Exposures in EV at which two pictures are compared, evenly spaced.
struct ExposureRange {
    double start_ev = 0;  // the reference's brightest light comes out at 0.85 of the display's white
    double stop_ev = 0;   // its median does
    int count = 2;        // one an EV, at least two
};

/// From the reference's luminance. Where more than half of it is black the median of the rest stands in (the paper's
/// own would be an infinite exposure). A black reference is seen at 0 EV alone.
ExposureRange hdr_flip_exposures(const ImageF& reference);

/// Light after an exposure and the ACES curve (Narkowicz 2015, "ACES Filmic Tone Mapping Curve", whose exposure of 0.6
/// is taken back as the authors do), cut to 0..1.
ImageF tone_mapped(const ImageF& light, double exposure_ev);

/// The largest LDR-FLIP error of every pixel over the exposures, 1 channel. Both images are linear Rec.709 light, 3
/// channels, of one size; samples must be finite, and those below 0 count as 0.
ImageF hdr_flip_error_map(const ImageF& reference, const ImageF& test, const FlipOptions& options = {});

}  // namespace matchlight
