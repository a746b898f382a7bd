// Hand-held photographs of a series moved onto one another.
#pragma once

#include <optional>
#include <vector>

#include "calibration/exposure_series.h"
#include "calibration/merge_setup.h"

namespace matchlight {

/// How a photograph moved against the reference: what the reference shows at x stands in it at
/// R(angle)·(x − c) + c + (right, down), c the picture's centre, x right and y down.
struct PhotographMotion {
    double right_px = 0, down_px = 0, angle_rad = 0;
};

/// A code that no photograph has: the picture does not reach there. It counts as full.
inline constexpr float outside_code = 2;

/// The motion of each photograph against the reference, from one exposure to the next, over pixels that both expose:
/// translation by phase correlation at a coarse scale, then translation and rotation to some tenths of a pixel by
/// the enhanced correlation coefficient (Evangelidis & Psarakis 2008, OpenCV's). Nothing for the reference, and
/// nothing where `only_seen` and a photograph does not agree with its neighbour clearly better when moved than when
/// moved the opposite way, which smooths noise as much.
std::vector<std::optional<PhotographMotion>> find_motions(const MergeSetup& setup, std::size_t reference,
                                                          bool only_seen);

/// The photograph as the reference sees it: light resampled by cubic interpolation; full where a full pixel takes part.
ImageF moved_codes(const ImageF& code, const PhotographMotion& motion, const CodeTable& table, const FullCodes& full);

}  // namespace matchlight
