// Where each shared unknown of a clip has its place in one vector.
#pragma once

#include <array>
#include <map>

#include "tracking/clip_model.h"

namespace matchlight {

/// Columns of the shared unknowns; −1, or absent, where a parameter is held.
struct SharedColumns {
    /// What `freedom` sets free, with what `model` holds.
    SharedColumns(const ClipModel& model, const ModelFreedom& freedom);
    /// None.
    SharedColumns() { lens.fill(-1); }

    bool any_lens() const;

    std::array<int, lens_parameter_count> lens{};
    int readout = -1;
    int plane = -1;              // turns about its x and y, then height: 3
    std::map<int, int> places;   // of free tags, by id: 6 each
    std::map<int, int> offsets;  // by id: 8 each
    int count = 0;
};

}  // namespace matchlight
