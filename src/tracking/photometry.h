// Exposure and white balance of every frame from the tags as grey cards, on the probe's scale.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tracking/grey_card.h"

namespace matchlight {

/// What one tag's card ought to send to the camera at exposure 0: (white − black albedo) · E(n) / π, in probe units.
/// Tags nearest the probe's place weigh most when the scale is set.
struct CardExpectation {
    std::array<double, 3> difference{1, 1, 1};
    std::array<double, 3> ink{0.05, 0.05, 0.05};  // black albedo · E(n) / π
    double weight = 1;
};

struct FramePhotometry {
    double exposure_ev = 0;  // plate light = probe light · 2^ev · white_balance
    std::array<double, 3> white_balance{1, 1, 1};
    double confidence = 0;  // 0..1
};

struct ClipPhotometry {
    std::vector<std::optional<FramePhotometry>> frames;
    bool white_balance_known = true;  // false where red or blue was clipped in every frame
};

/// log(reading / expectation) = exposure of the frame + offset of the tag, solved for both, robustly, channel by
/// channel: a tag that lies in shadow, or that comes and goes, does not move the exposure of the frames it is seen in.
/// The offsets' weighted median is zero. Ink alone joins as if it were a further tag of lower weight: its gloss makes
/// its offset unknown, but frames that show both tie it in, so exposure is still followed where paper is clipped.
/// Without a probe (`relative`) paper is taken as neutral and the exposure as 0 in the first frame. Every frame is
/// estimated from its own pixels: nothing is smoothed over time.
ClipPhotometry solve_photometry(const std::vector<std::vector<CardReading>>& readings,
                                const std::map<int, CardExpectation>& expectations, bool relative);

}  // namespace matchlight
