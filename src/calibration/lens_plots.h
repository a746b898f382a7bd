// The plots of a calibration's page, as SVG.
#pragma once

#include <string>

#include "calibration/lens_calibration.h"

namespace matchlight {

/// What the fit leaves over at every corner, as arrows over the picture.
struct ArrowPlot {
    std::string svg;
    double magnification = 1;
};
ArrowPlot residual_arrows_svg(const LensCalibration& calibration);
/// How many corners lie in each part of the picture.
std::string coverage_svg(const LensCalibration& calibration);
/// By how much the parameters' uncertainty moves each part of the picture.
std::string uncertainty_svg(const LensCalibration& calibration);
/// Root mean square of each view.
std::string view_bars_svg(const LensCalibration& calibration);
/// Residuals along the radius against the distance from the principal point, with their running mean.
std::string radial_residuals_svg(const LensCalibration& calibration);

}  // namespace matchlight
