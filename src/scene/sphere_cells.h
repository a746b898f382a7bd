// Groups the spheres of a set into cells of neighbours, so that what is not seen is passed over by the thousand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/sphere_set.h"

namespace matchlight {

/// Neighbours, one after another in SphereCells::order: mixed, so that the first few of a cell are an even choice of
/// all of them; those at one place as in the set.
struct SphereCell {
    std::uint32_t first = 0, count = 0;
    std::array<float, 3> low_m{}, high_m{};  // of the spheres, not of their centres alone
    float largest_radius_m = 0;
};

struct SphereCells {
    std::vector<std::uint32_t> order;  // indices into the set, each once
    std::vector<SphereCell> cells;     // none is empty
};

/// Sorts into an even grid, and halves what holds too many at the median of its longest side, until no cell has more
/// than `most`, which is at least 1; only spheres with the very same centre may be more.
SphereCells sphere_cells(const SphereSet& set, std::size_t most);

}  // namespace matchlight
