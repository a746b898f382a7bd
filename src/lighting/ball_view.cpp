// A camera place from which a mirror ball was photographed, and all that is found out about it.
#include "lighting/ball_view.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "lighting/halved_image.h"

namespace matchlight {

std::optional<Eigen::Vector2d> direct_pixel(const BallView& view, const MirrorBall& ball,
                                            const Eigen::Vector3d& place_m, double clear) {
    if (!view.in_front(place_m)) return std::nullopt;
    const Eigen::Vector3d eye = view.eye_m();
    const Eigen::Vector3d way = place_m - eye;
    if (miss_ratio(ball, eye, way.normalized()) < clear) return std::nullopt;
    const Eigen::Vector2d normalized = (*view.camera_from_world * place_m).hnormalized();
    // Far outside any frame lens models fold.
    if (!(normalized.norm() < 3)) return std::nullopt;
    const Eigen::Vector2d pixel = view.camera.pixel_from_normalized(normalized);
    if (!view.in_frame(pixel)) return std::nullopt;
    return pixel;
}

Eigen::Vector3d sample_rgb(const ImageF& image, const Eigen::Vector2d& pixel) {
    const double x = std::clamp(pixel.x(), 0.0, image.width() - 1.0);
    const double y = std::clamp(pixel.y(), 0.0, image.height() - 1.0);
    const int left = std::min(static_cast<int>(x), std::max(0, image.width() - 2));
    const int top = std::min(static_cast<int>(y), std::max(0, image.height() - 2));
    const int right = std::min(left + 1, image.width() - 1), bottom = std::min(top + 1, image.height() - 1);
    const double across = x - left, down = y - top;
    const auto at = [&](int px, int py) {
        return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(image.pixel(px, py)).cast<double>());
    };
    return (at(left, top) * (1 - across) + at(right, top) * across) * (1 - down) +
           (at(left, bottom) * (1 - across) + at(right, bottom) * across) * down;
}

BallView halved(const BallView& view) {
    const int width = view.radiance.width() / 2, height = view.radiance.height() / 2;
    BallView result;
    result.name = view.name;
    result.outline = view.outline;
    result.camera_from_world = view.camera_from_world;
    result.radiance = halved(view.radiance, width, height);
    if (!view.sigma.empty()) result.sigma = halved(view.sigma, width, height);
    if (!view.clipped.empty()) {
        result.clipped = Image8(width, height, 1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                result.clipped.at(x, y) =
                    std::max({view.clipped.at(2 * x, 2 * y), view.clipped.at(2 * x + 1, 2 * y),
                              view.clipped.at(2 * x, 2 * y + 1), view.clipped.at(2 * x + 1, 2 * y + 1)});
            }
        }
    }
    result.camera = view.camera;
    result.camera.width = width;
    result.camera.height = height;
    // Centres at whole numbers: pixel 0 of the half is the middle of pixels 0 and 1.
    result.camera.fx /= 2, result.camera.fy /= 2;
    result.camera.cx = (view.camera.cx - 0.5) / 2;
    result.camera.cy = (view.camera.cy - 0.5) / 2;
    return result;
}

}  // namespace matchlight
