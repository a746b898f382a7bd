// The lens grid against the exact inverse.
#include "compositor/lens_map.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

Camera wide_lens() {
    Camera camera;
    camera.width = 1920;
    camera.height = 1080;
    camera.fx = camera.fy = 1400;
    camera.cx = 950;
    camera.cy = 545;
    camera.distortion = {-0.28, 0.09, 0.0005, -0.0003, -0.01};
    return camera;
}

TEST(LensMap, InterpolatesWithinATenthOfTheRegistrationError) {
    const Camera camera = wide_lens();
    const LensMap map = make_lens_map(camera);
    double worst_px = 0;
    for (int y = 0; y < camera.height; y += 13) {
        for (int x = 0; x < camera.width; x += 11) {
            const Eigen::Vector2d difference =
                map.normalized(x, y) - camera.normalized_from_pixel(Eigen::Vector2d(x, y));
            worst_px = std::max(worst_px, difference.norm() * camera.fx);
        }
    }
    // spacing² / 8 · the second derivative of the inverse lens, largest in the corners of this strong barrel.
    EXPECT_LT(worst_px, 5e-3);
}

TEST(LensMap, CoversTheLastPixel) {
    Camera camera = wide_lens();
    camera.width = 641;
    camera.height = 361;
    const LensMap map = make_lens_map(camera);
    EXPECT_TRUE(map.normalized(640, 360).allFinite());
}

}  // namespace
}  // namespace matchlight
