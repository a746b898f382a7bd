// The page that shows a calibration: where corners lay, what the lens leaves over, how sure each number is.
#pragma once

#include <string>
#include <vector>

#include "calibration/board_search.h"
#include "calibration/lens_calibration.h"
#include "calibration/lens_comparison.h"

namespace matchlight {

/// What a page says besides the calibration itself.
struct LensPageContext {
    std::string source;  // what was calibrated from: "13 photographs", "calibration.mp4"
    std::vector<ComparedCalibration> compared;
};

/// One HTML page that needs nothing else: plots as SVG.
std::string lens_page(const LensCalibration& calibration, const LensPageContext& context);

}  // namespace matchlight
