// Where nothing is turned, the resampling that keeps energy does; else points are looked up.
#include "lighting/panorama.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "lighting/latlong_grid.h"
#include "lighting/mappings.h"

namespace matchlight {
namespace {

/// With the share that is seen as fourth channel.
StitchedSphere with_holes(const ImageF& light, const ImageF& clipped) {
    StitchedSphere sphere{ImageF(light.width(), light.height(), 4), 0, clipped};
    const LatlongGrid grid(light.width(), light.height());
    for (int y = 0; y < light.height(); ++y) {
        int seen = 0;
        for (int x = 0; x < light.width(); ++x) {
            const float* from = light.pixel(x, y);
            float* to = sphere.latlong.pixel(x, y);
            std::copy_n(from, 3, to);
            const bool hole = from[0] == 0 && from[1] == 0 && from[2] == 0;
            to[3] = hole ? 0.0f : 1.0f;
            seen += hole ? 0 : 1;
        }
        sphere.seen_share += seen * grid.solid_angle(y) / (4 * std::numbers::pi);
    }
    return sphere;
}

/// Near the poles a row's pixels are far narrower than high, and a lattice of points would miss some of them: each
/// becomes the mean over as many as are as wide as one is high. A row's sum stays what it is.
ImageF evened_at_poles(const ImageF& image) {
    ImageF evened = image;
    const int width = image.width(), channels = image.channels();
    for (int y = 0; y < image.height(); ++y) {
        const double narrow = std::sin(std::numbers::pi * (y + 0.5) / image.height());
        // Half of the pixels that many to either side; the two at the ends in part.
        const double reach = std::min(0.5 / narrow, width / 2.0) - 0.5;
        const int whole = static_cast<int>(std::floor(std::max(0.0, reach)));
        const double part = std::max(0.0, reach) - whole, total = 1 + 2 * std::max(0.0, reach);
        if (reach < 0.05) continue;
        for (int c = 0; c < channels; ++c) {
            const auto at = [&](int x) { return static_cast<double>(image.at(((x % width) + width) % width, y, c)); };
            double sum = 0;
            for (int x = -whole; x <= whole; ++x) sum += at(x);
            for (int x = 0; x < width; ++x) {
                evened.at(x, y, c) =
                    static_cast<float>(std::max(0.0, (sum + part * (at(x - whole - 1) + at(x + whole + 1))) / total));
                sum += at(x + whole + 1) - at(x - whole);
            }
        }
    }
    return evened;
}

}  // namespace

bool is_panorama_shape(int width, int height) {
    return height > 0 && std::abs(width - 2 * height) <= 2;
}

StitchedSphere panorama_sphere(const ImageF& light, const ImageF& clipped, const Eigen::Matrix3d& world_from_picture,
                               int height) {
    const ProbeLayout layout{ProbeMapping::latlong, {}, light.width(), light.height(), false};
    if (world_from_picture.isIdentity(1e-12)) {
        StitchedSphere sphere = with_holes(light, clipped);
        const ImageF all = resampled(sphere, layout, layout_of_size(ProbeMapping::latlong, height));
        sphere.latlong = channels_of(all, 0, 4);
        if (all.channels() == 5) sphere.clipped = channels_of(all, 4, 1);
        return sphere;
    }
    const ImageF even_light = evened_at_poles(light);
    const ImageF even_clipped = clipped.empty() ? ImageF() : evened_at_poles(clipped);
    SphereView view;
    view.light = &even_light;
    view.clipped = clipped.empty() ? nullptr : &even_clipped;
    view.view_from_world = world_from_picture.transpose();
    view.look = [layout](const Eigen::Vector3d& direction) {
        return ViewPoint{pixel_from_direction(layout, direction), 1};
    };
    view.wraps = true;
    view.black_is_unseen = true;
    view.px_per_radian = light.height() / std::numbers::pi;
    return stitched_sphere({&view, 1}, height);
}

}  // namespace matchlight
