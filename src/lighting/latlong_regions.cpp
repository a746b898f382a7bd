// Connected pixels of a lat-long image.
#include "lighting/latlong_regions.h"

#include "core/image.h"

namespace matchlight {

std::vector<LatlongRegion> latlong_regions(int width, int height, const std::function<bool(int x, int y)>& belongs) {
    Image8 taken(width, height, 1);
    std::vector<LatlongRegion> regions;
    for (int start = 0; start < width * height; ++start) {
        LatlongRegion region, queue = {{start % width, start / width}};
        while (!queue.empty()) {
            const auto [x, y] = queue.back();
            queue.pop_back();
            if (taken.at(x, y) != 0 || !belongs(x, y)) continue;
            taken.at(x, y) = 1;
            region.emplace_back(x, y);
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    if (y + dy >= 0 && y + dy < height) queue.emplace_back((x + dx + width) % width, y + dy);
                }
            }
        }
        if (!region.empty()) regions.push_back(std::move(region));
    }
    return regions;
}

}  // namespace matchlight
