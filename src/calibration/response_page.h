// The page that shows a response: its curve, and what pixels left over.
#pragma once

#include <string>

#include "calibration/exposure_series.h"
#include "calibration/response_fit.h"

namespace matchlight {

/// One HTML page that needs nothing else: plots as SVG.
std::string response_page(const ResponseFit& fit, const ExposureSeries& series);

}  // namespace matchlight
