// The camera's path from above and from the side, as SVG.
#pragma once

#include <string>

#include "tracking/solve_file.h"

namespace matchlight {

/// World x to the right; y (from above) or z (from the side) up; one scale for both axes. The path breaks where there
/// is no pose, bridged frames are marked, ticks show where the camera looks, tags are drawn where they lie.
std::string path_plot_svg(const Solve& solve, bool from_above);

}  // namespace matchlight
