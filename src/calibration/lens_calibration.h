// From views of a board to a lens with its uncertainty: outliers, choice of the model, what the views determine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/camera.h"
#include "calibration/lens_choice.h"
#include "calibration/lens_fit.h"
#include "core/warnings.h"

namespace matchlight {

/// What the user may force; everything else is found out.
struct LensOptions {
    std::optional<LensModel> lens;
    int least_radial_terms = 2, most_radial_terms = 6;  // of radtan
};

struct ParameterEstimate {
    std::string name;  // "fx", …, "k1", …
    double value = 0;
    double sigma = 0;           // the larger of the next two: what is written
    double sigma_of_noise = 0;  // from the scatter of the corners, if all errors were independent
    double sigma_of_views = 0;  // from leaving views out (jackknife)
};

/// How far the parameters' uncertainty moves a pixel, rotations of the camera taken out; on a grid over the picture.
struct PixelUncertainty {
    int columns = 0, rows = 0;
    std::vector<double> sigma_px;  // row by row; NaN where the lens does not reach
    double rms_px = 0, worst_px = 0;
};

struct LensCalibration {
    LensData data;  // the corners that were used
    LensFit fit;
    Camera camera;  // with sigmas
    std::vector<ParameterEstimate> parameters;
    std::vector<double> bend_sigma_m;  // empty for a flat board
    std::vector<CandidateScore> candidates;
    double held_out_px = 0;
    std::vector<double> view_rms_px;
    std::vector<double> view_tilt_deg;  // of the board against the ray to its middle
    PixelUncertainty pixels;
    std::size_t distinct_views = 0;  // of the views, those that show the board in another place, size or tilt
    double coverage = 0;             // share of the picture with a corner near, 0 to 1
    std::vector<std::string> dropped_views;
    int dropped_corners = 0;
};

/// Throws InputError where the views do not determine the lens, saying what is missing. Warns of dropped corners and
/// views, of parts of the picture that no corner covers.
LensCalibration calibrate_lens(LensData data, const LensOptions& options, Warnings& warnings);

/// Where in the picture corners are: one count for each cell of a grid, row by row.
std::vector<int> coverage_counts(const LensData& data, int columns, int rows);

}  // namespace matchlight
