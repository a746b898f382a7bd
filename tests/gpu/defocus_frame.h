// Layers out of focus made up on the CPU, and what a method makes of them.
#pragma once

#include <cmath>
#include <functional>

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "report/defocus_reference.h"

namespace matchlight::test {

using AddDefocus = std::function<GraphTexture(RenderGraph&, ShaderLibrary&, const DefocusInput&)>;

/// Runs a method on `region` of the images, which is all of the frame unless it is given; what it makes of that, over
/// the frame.
inline ImageF run_defocus(ShaderLibrary& shaders, const DefocusImages& images, const AddDefocus& add,
                          Region region = {}) {
    const Region frame = images.light.bounds();
    if (region.empty()) region = frame;
    // Any focus does: the circles are turned back to depths by it.
    const Focus focus{.coc_scale_px_m = 4096, .focus_distance_m = 0.25};
    ImageF light(region.width, region.height, 4), inverse_depth(region.width, region.height, 1);
    CocRange range;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            const int u = x + region.x, v = y + region.y;
            for (int c = 0; c < 4; ++c) light.at(x, y, c) = static_cast<float>(images.light.at(u, v, c));
            if (!images.covered(u, v)) continue;
            const double coc = images.coc_px.at(u, v);
            inverse_depth.at(x, y) = static_cast<float>(1 / focus.focus_distance_m - coc / focus.coc_scale_px_m);
            range.extend({coc, coc});
        }
    }
    const auto upload = [](const ImageF& image, GLenum format) {
        Texture2D texture(TextureShape{.format = format, .width = image.width(), .height = image.height()});
        texture.upload(image);
        return texture;
    };
    const Texture2D light_texture = upload(light, GL_RGBA32F), depth_texture = upload(inverse_depth, GL_R32F);
    RenderGraph graph;
    graph.begin_frame(frame.width, frame.height);
    const DefocusInput input{.light = graph.import(&light_texture, {GL_RGBA32F, region, 1}),
                             .inverse_depth = graph.import(&depth_texture, {GL_R32F, region, 1}),
                             .focus = focus,
                             .range = range,
                             .bokeh = {}};
    const GraphTexture made = add(graph, shaders, input);
    graph.output(made);
    graph.run();
    const Region written = graph.shape(made).region;
    const ImageF texels = graph.texture(made).read<float>({0, 0, written.width, written.height}, 4);
    ImageF result(frame.width, frame.height, 4);
    for (int y = 0; y < written.height; ++y) {
        for (int x = 0; x < written.width; ++x) {
            if (!frame.contains(x + written.x, y + written.y)) continue;
            std::copy_n(texels.pixel(x, y), 4, result.pixel(x + written.x, y + written.y));
        }
    }
    return result;
}

/// A square in focus before a slope whose circles grow from far before the focus to far behind it, with a highlight and
/// a translucent band; the frame's left part is empty.
inline DefocusImages slope_and_square(int width, int height, double widest_coc_px) {
    DefocusImages images(width, height);
    for (int y = height / 8; y < height * 7 / 8; ++y) {
        for (int x = width / 4; x < width; ++x) {
            const double t = static_cast<double>(x - width / 4) / (width - width / 4 - 1);
            // A 64th of a pixel is exact in run_defocus()'s depths.
            images.set(x, y, (x / 3 + y / 5) % 2 == 0 ? 0.2 : 0.9, std::round(64 * widest_coc_px * (2 * t - 1)) / 64);
            if (y < height / 4) {
                for (int c = 0; c < 4; ++c) images.light.at(x, y, c) *= 0.5;
            }
        }
    }
    for (int y = height / 2; y < height * 3 / 4; ++y) {
        for (int x = width * 5 / 8; x < width * 3 / 4; ++x) images.set(x, y, 0.6, 0);
    }
    images.set(width * 2 / 5, height / 3, 1e3, images.coc_px.at(width * 2 / 5, height / 3));
    return images;
}

/// Greatest difference, relative to what is there where that is more than 1.
inline double worst_difference(const ImageF& result, const ImageD& expected) {
    double worst = 0;
    for (std::size_t i = 0; i < result.samples().size(); ++i) {
        const double difference = std::abs(result.samples()[i] - expected.samples()[i]);
        worst = std::max(worst, difference / std::max(1.0, expected.samples()[i]));
        if (!std::isfinite(result.samples()[i])) return HUGE_VAL;
    }
    return worst;
}

template <class Picture>
double sum_of(const Picture& picture, int channel) {
    double sum = 0;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) sum += picture.at(x, y, channel);
    }
    return sum;
}

}  // namespace matchlight::test
