// Looking lat-long images up between their pixels, and turning them about the vertical.
#include "lighting/latlong_lookup.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lighting/probe.h"

namespace matchlight {
namespace {

int wrapped(int x, int width) {
    const int remainder = x % width;
    return remainder < 0 ? remainder + width : remainder;
}

}  // namespace

LatlongTaps::LatlongTaps(const Eigen::Vector3d& towards, int width, int height) {
    const Eigen::Vector2d at = latlong_pixel(towards, width, height);
    const double left = std::floor(at.x()), top = std::floor(at.y());
    across = at.x() - left, down = at.y() - top;
    for (int k = 0; k < 2; ++k) {
        x[k] = wrapped(static_cast<int>(left) + k, width);
        y[k] = std::clamp(static_cast<int>(top) + k, 0, height - 1);
    }
}

ImageF turned_latlong(const ImageF& latlong, double rotation_deg, double gain) {
    const int width = latlong.width();
    // Azimuth runs clockwise seen from above, so what is turned counter-clockwise moves to the left: each pixel takes
    // what lay to its right. Interpolation between columns keeps the sum of every row, so energy is exact.
    double shift = std::fmod(rotation_deg / 360.0, 1.0) * width;
    if (shift < 0) shift += width;
    const int whole = static_cast<int>(std::floor(shift));
    const double part = shift - whole;
    ImageF result(width, latlong.height(), latlong.channels());
    for (int y = 0; y < latlong.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            const float* near = latlong.pixel(wrapped(x + whole, width), y);
            const float* far = latlong.pixel(wrapped(x + whole + 1, width), y);
            for (int c = 0; c < latlong.channels(); ++c) {
                const double value = near[c] * (1 - part) + far[c] * part;
                // A large exposure must not make infinities of finite light.
                constexpr double largest = std::numeric_limits<float>::max();
                result.at(x, y, c) = static_cast<float>(std::min(value * gain, largest));
            }
        }
    }
    return result;
}

}  // namespace matchlight
