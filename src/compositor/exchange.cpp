// Sends both ends of every way through the lens.
#include "compositor/exchange.h"

#include "core/parallel.h"

namespace matchlight {

ImageF motion_px(const ImageF& ways, const Region& region, const Camera& camera, const LensMap& lens_map) {
    ImageF motion(ways.width(), ways.height(), 4);
    parallel_for(ways.height(), [&](int y) {
        for (int x = 0; x < ways.width(); ++x) {
            const Eigen::Vector2d here = lens_map.normalized(region.x + x, region.y + y);
            const Eigen::Vector2d here_px = camera.pixel_from_normalized(here);
            for (const int to : {0, 2}) {
                const Eigen::Vector2d way(ways.at(x, y, to), ways.at(x, y, to + 1));
                if (way.isZero(0)) continue;
                const Eigen::Vector2d change = camera.pixel_from_normalized(here + way) - here_px;
                // A way to behind the camera, or to where the lens model does not reach.
                if (!change.allFinite()) continue;
                motion.at(x, y, to) = static_cast<float>(change.x());
                motion.at(x, y, to + 1) = static_cast<float>(-change.y());
            }
        }
    });
    return motion;
}

}  // namespace matchlight
