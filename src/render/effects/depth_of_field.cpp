// What the methods share.
#include "render/effects/depth_of_field.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

double CocRange::widest_px() const {
    return std::max(std::abs(nearest_px), std::abs(farthest_px));
}

void CocRange::extend(const CocRange& other) {
    nearest_px = std::min(nearest_px, other.nearest_px);
    farthest_px = std::max(farthest_px, other.farthest_px);
}

}  // namespace matchlight
