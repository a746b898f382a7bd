// Exposure and white balance of every frame from the tags as grey cards, on the probe's scale.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tracking/grey_card.h"
#include "tracking/vignette_fit.h"

namespace matchlight {

/// What one tag's card ought to send to the camera at exposure 0: (white − black albedo) · E(n) / π, in probe units.
/// Tags nearest the probe's place, and those the probe itself shows, weigh most when the scale is set.
struct CardExpectation {
    std::array<double, 3> difference{1, 1, 1};
    std::array<double, 3> ink{0.05, 0.05, 0.05};  // black albedo · E(n) / π
    /// What it does send where it lies, cast light and true albedo included, where the probe shows that tag.
    std::optional<std::array<double, 3>> shown_difference;
    double weight = 1;
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  // from where exposure is stated
};

struct FramePhotometry {
    double exposure_ev = 0;  // plate light = probe light · 2^ev · white_balance · vignette
    std::array<double, 3> white_balance{1, 1, 1};
    double confidence = 0;  // 0..1
    bool measured = false;  // otherwise from its neighbours
};

struct ClipPhotometry {
    std::vector<std::optional<FramePhotometry>> frames;
    bool white_balance_known = true;  // false where red or blue was clipped in every frame
    std::optional<Vignette> vignette;
    std::optional<Eigen::Vector3d> light_gradient_ev_per_m;
};

/// log(reading / expectation) = exposure of the frame + offset of the tag + fall-off of the lens (fit_light): a tag
/// that lies in shadow, or that comes and goes, does not move the exposure of the frames it is seen in. Exposure is
/// that at place 0: the offsets' weighted median is zero there, once a light that changes evenly over the tags is taken
/// from them. Ink alone joins as if it were a further tag of lower weight: its gloss makes its offset unknown, but
/// frames that show both tie it in, the nearest most, so exposure is still followed where paper is clipped. Without a
/// probe (`relative`) paper is taken as neutral and the exposure as 0 in the first frame. Every frame with unclipped
/// paper is estimated from its own pixels: nothing is smoothed over time.
ClipPhotometry solve_photometry(const std::vector<std::vector<CardReading>>& readings,
                                const std::map<int, CardExpectation>& expectations, bool relative);

}  // namespace matchlight
