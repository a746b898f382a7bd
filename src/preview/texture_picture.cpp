// Nearest texels, one white for the whole texture.
#include "preview/texture_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/transfer.h"

namespace matchlight {

namespace {

struct Range {
    double least = 0, most = 0;
};

Range range_of(const ImageF& texels) {
    Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (int y = 0; y < texels.height(); ++y) {
        for (int x = 0; x < texels.width(); ++x) {
            for (int c = 0; c < std::min(3, texels.channels()); ++c) {
                const double value = texels.at(x, y, c);
                // An empty texel of depth (reversed z) would make all others one white.
                if (!std::isfinite(value) || (texels.channels() == 1 && value == 0)) continue;
                range.least = std::min(range.least, value);
                range.most = std::max(range.most, value);
            }
        }
    }
    return range.least <= range.most ? range : Range{};
}

/// Where in the texture a pixel of the frame lies; outside it is black.
struct Placement {
    double texels_per_pixel = 1, left = 0, top = 0;
};

Placement placement_of(const WatchedTexture& texture, int width, int height) {
    const GraphShape& shape = texture.shape;
    const Region pixels = shape.frame_pixels();
    const bool is_as_declared =
        shape.region.width == texture.texels.width() && shape.region.height == texture.texels.height();
    const Region frame{0, 0, width + shape.scale, height + shape.scale};  // the last texels may reach over its edge
    if (is_as_declared && pixels == pixels.intersected(frame)) {
        return {1.0 / shape.scale, static_cast<double>(shape.region.x), static_cast<double>(shape.region.y)};
    }
    const double step = std::max(static_cast<double>(texture.texels.width()) / width,
                                 static_cast<double>(texture.texels.height()) / height);
    return {step, (width * step - texture.texels.width()) / 2, (height * step - texture.texels.height()) / 2};
}

}  // namespace

Image8 picture_of_texture(const WatchedTexture& texture, int width, int height) {
    Image8 picture(width, height, 3);
    const ImageF& texels = texture.texels;
    const Range range = range_of(texels);
    const bool is_depth = texels.channels() == 1;
    const double black = is_depth ? range.least : std::min(0.0, range.least);
    const double white = range.most > black ? range.most : black + 1;
    const Placement placement = placement_of(texture, width, height);
    const auto code_of = [&](double value) {
        const double light = std::clamp((value - black) / (white - black), 0.0, 1.0);
        return static_cast<std::uint8_t>(std::lround(255 * srgb_code_from_linear(light)));
    };
    for (int y = 0; y < height; ++y) {
        const int v = static_cast<int>(std::floor((y + 0.5) * placement.texels_per_pixel - placement.top));
        for (int x = 0; x < width; ++x) {
            const int u = static_cast<int>(std::floor((x + 0.5) * placement.texels_per_pixel - placement.left));
            if (!texels.bounds().contains(u, v)) continue;
            const float* texel = texels.pixel(u, v);
            std::uint8_t* pixel = picture.pixel(x, y);
            bool finite = true;
            for (int c = 0; c < 3; ++c) {
                const float value = texel[is_depth ? 0 : c];
                finite = finite && std::isfinite(value);
                pixel[c] = std::isfinite(value) ? code_of(value) : 0;
            }
            if (!finite) pixel[0] = pixel[2] = 255, pixel[1] = 0;
        }
    }
    return picture;
}

std::string words_of_texture(const WatchedTexture& texture) {
    const Range range = range_of(texture.texels);
    const std::string size = texture.shape.scale > 1 ? fmt::format(" of {} pixels", texture.shape.scale) : "";
    return fmt::format("{}: {}×{} texels{}, {:.4g} to {:.4g}", texture.pass, texture.texels.width(),
                       texture.texels.height(), size, range.least, range.most);
}

}  // namespace matchlight
