// Which frames of a video calibrate a lens best: sharp ones, and far apart in where and how they show the board.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/lens_fit.h"

namespace matchlight {

/// Indices, in rising order, of at most `count` of `data.views`: first the sharpest, then each time the one that is
/// furthest from those chosen (Gonzalez, "Clustering to Minimize the Maximum Intercluster Distance", 1985) in the
/// board's place in the picture, its size and its tilt, sharper and fuller views first. Blurred ones are left out while
/// there are enough others. The same views always give the same choice.
std::vector<std::size_t> choose_views(const LensData& data, std::size_t count);

/// How many of the views differ: by a twentieth of the picture in the board's place or size, or three degrees of its
/// tilt. What many alike views have in common, such as a corner hidden behind a glint, does not average out over them.
std::size_t distinct_views(const LensData& data);

}  // namespace matchlight
