// A frame of the footage with what the solve says drawn over it.
#pragma once

#include <string>

#include "core/image.h"
#include "report/solve_findings.h"

namespace matchlight {

/// How much longer than they are the residuals are drawn.
inline constexpr double overlay_magnification = 20;

/// Yellow: the tags of the rig where pose and lens put them; cyan: the corners that were found, with their residuals
/// as red lines, magnified; red, green, blue: the world's x, y, z. At most 960 pixels wide, as the data URL of a JPEG.
/// Throws InputError when it cannot be encoded.
std::string solve_overlay_url(const Image8& picture, const Solve& solve, const SolvedFrame& frame,
                              const FrameResiduals& findings);

}  // namespace matchlight
