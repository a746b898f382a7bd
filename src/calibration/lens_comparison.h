// The same views given to OpenCV's calibration, held against ours.
#pragma once

#include <string>
#include <vector>

#include "calibration/lens_calibration.h"

namespace matchlight {

struct ComparedCalibration {
    std::string name;
    double rms_px = 0;       // of the fit to all views
    double held_out_px = 0;  // over the folds of the cross-validation
    Camera camera;
};

/// cv::calibrateCamera with its five coefficients on our corners, and on those of cv::cornerSubPix where they were
/// measured: the same views, the same folds, and of each view left out only the board's pose is fitted.
std::vector<ComparedCalibration> compare_with_opencv(const LensCalibration& calibration);

}  // namespace matchlight
