// The camera's response from paper and ink seen at several exposures.
#pragma once

#include <vector>

#include "calibration/response.h"
#include "tracking/grey_card.h"

namespace matchlight {

struct ResponseFit {
    Response response = Response::srgb();  // the best, sRGB where nothing better is told
    bool told = false;                     // exposures change enough to tell, and enough is seen
    double exposure_range_ev = 0;          // over which unclipped paper was seen
    double gain_over_srgb = 0;             // in χ², less the penalty for the family's parameter; above 6: strong
};

/// Under the right curve the ratio of paper to ink keeps one value for each tag whatever the exposure, whatever the
/// lens' fall-off, and on average nearly that of the albedos (`paper_over_ink`), less a gloss on the ink. The first
/// tells the curve's shape, the second its overall exponent, which ratios alone cannot (Grossberg & Nayar 2003).
/// Families: sRGB, one exponent, sRGB with a shoulder above a knee; chosen by χ² with Schwarz's penalty (1978) on
/// readings that count once for each tag, channel and tenth of a stop.
ResponseFit fit_response(const std::vector<std::vector<CardReading>>& readings, double paper_over_ink);

}  // namespace matchlight
