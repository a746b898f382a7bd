// The clip from its first frame to its last: what the solve knows of each, and where we are.
#pragma once

#include <cstdint>
#include <optional>

#include "core/image.h"
#include "preview/controls.h"
#include "preview/session.h"

namespace matchlight {

/// Takes part in ImGui's frame: buttons, and a strip on which the frame is dragged.
void lay_out_timeline(Session& session, Controls& controls, const Region& area, float scale);

/// Lowest and highest of a curve over the solve's frames; nullopt where nothing is known.
struct CurveRange {
    double lowest = 0, highest = 0;
};
std::optional<CurveRange> range_of(const Solve& solve, std::optional<double> SolvedFrame::*curve);

}  // namespace matchlight
