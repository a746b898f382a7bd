// Which model describes a lens: the simplest whose held-out error is not worse than the best's by more than chance.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/lens_fit.h"

namespace matchlight {

/// A candidate with what cross-validation says of it.
struct CandidateScore {
    LensCandidate candidate;
    LensFit fit;  // to all views
    std::vector<LensFit> fold_fits;
    std::vector<double> held_out_square_px;  // mean square of each view's corners, by a lens made without the view
    double held_out_px = 0;                  // root of their mean over all corners
    double excess_px2 = 0;                   // mean square above the best candidate's, and its standard error,
    double excess_error_px2 = 0;             // from view to view
    bool reaches_corners = true;             // the model does not fold back where corners lie
    bool chosen = false;
};

/// Fold of a view: every `folds`th, so that neighbours in time are held out at different times.
std::size_t fold_count(std::size_t views);

/// Root mean square, pixels, of each view's corners when the lens was made without the view; only the board's pose in
/// it is fitted to it. `fits` gets the lens of each fold.
std::vector<double> held_out_squares(const LensData& data, const LensFit& fit, std::vector<LensFit>& fits);

/// Fits and cross-validates all candidates from `starts` (a radial-tangential and a fisheye one, either may be absent)
/// and marks the chosen one. Breiman, Friedman, Olshen & Stone, "Classification and Regression Trees" (1984), the
/// one-standard-error rule, with differences taken view by view, and never for less than a hundredth of the error.
std::vector<CandidateScore> score_candidates(const LensData& data, const std::vector<LensCandidate>& candidates,
                                             const std::vector<LensFit>& starts);

}  // namespace matchlight
