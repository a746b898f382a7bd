// One label for every pixel of a lat-long map, cheap by itself and smooth with its neighbours.
#pragma once

#include <cstddef>
#include <vector>

#include "core/image.h"

namespace matchlight {

/// Cost of every label at every pixel, pixels by rows, labels together.
struct LabelCosts {
    int width, height, labels;
    std::vector<float> cost;

    LabelCosts(int columns, int rows, int count)
        : width(columns),
          height(rows),
          labels(count),
          cost(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(count)) {}

    float* at(int x, int y) { return cost.data() + (static_cast<std::size_t>(y) * width + x) * labels; }
    const float* at(int x, int y) const { return cost.data() + (static_cast<std::size_t>(y) * width + x) * labels; }
};

/// What neighbours with different labels cost: `step` where they differ by one, `jump` where by more. A jump is divided
/// by 1 + the difference of `guide` (1 channel) over `contrast`, to 1 at most: surfaces end where the picture does, but
/// a lamp before a wall is no more of an end than a dark frame.
struct LabelPenalties {
    float step = 0, jump = 0, contrast = 1;
};

/// Every label's mean cost over 3 × 3 pixels.
LabelCosts smoothed(const LabelCosts& costs);

/// The costs added up along eight paths to every pixel, across the seam too (semi-global matching; Hirschmüller 2008,
/// "Stereo Processing by Semiglobal Matching and Mutual Information", eq. 13).
LabelCosts semi_global_sums(const LabelCosts& costs, const ImageF& guide, const LabelPenalties& penalties);

}  // namespace matchlight
