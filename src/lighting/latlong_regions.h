// Connected pixels of a lat-long image.
#pragma once

#include <functional>
#include <utility>
#include <vector>

namespace matchlight {

/// Column and row of each, in the order in which they are met.
using LatlongRegion = std::vector<std::pair<int, int>>;

/// Those that belong, joined eight ways and across the seam.
std::vector<LatlongRegion> latlong_regions(int width, int height, const std::function<bool(int x, int y)>& belongs);

}  // namespace matchlight
