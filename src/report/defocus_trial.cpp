// Up to the GPU, through a graph of its own, and back.
#include "report/defocus_trial.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace matchlight {

namespace {

Texture2D uploaded(const ImageF& image, GLenum format) {
    Texture2D texture(TextureShape{.format = format, .width = image.width(), .height = image.height()});
    texture.upload(image);
    return texture;
}

}  // namespace

ImageF run_defocus(ShaderLibrary& shaders, const DefocusImages& images, const AddDefocus& add, Region region) {
    const Region frame = images.light.bounds();
    if (region.empty()) region = frame;
    // Powers of two, so that circles come back from depths as they went.
    const Focus focus{.coc_scale_px_m = 4096, .focus_distance_m = 0.25};
    ImageF light(region.width, region.height, 4), inverse_depth(region.width, region.height, 1);
    CocRange range;
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            const int u = x + region.x, v = y + region.y;
            for (int c = 0; c < 4; ++c) light.at(x, y, c) = static_cast<float>(images.light.at(u, v, c));
            if (!images.covered(u, v)) continue;
            const double coc = images.coc_px.at(u, v);
            assert(coc < focus.coc_scale_px_m / focus.focus_distance_m);  // infinity's
            inverse_depth.at(x, y) = static_cast<float>(1 / focus.focus_distance_m - coc / focus.coc_scale_px_m);
            range.extend({coc, coc});
        }
    }
    const Texture2D light_texture = uploaded(light, GL_RGBA32F), depth_texture = uploaded(inverse_depth, GL_R32F);
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

double share_beside_disc(const ImageF& picture, int x, int y, double coc_px) {
    ImageD disc(picture.width(), picture.height(), 1);
    double area = 0;
    for (const DefocusTap& tap : bokeh_taps({}, coc_px / 2, false)) {
        disc.at(x + tap.x, y + tap.y) = tap.area_px2;
        area += tap.area_px2;
    }
    double difference = 0;
    for (int v = 0; v < picture.height(); ++v) {
        for (int u = 0; u < picture.width(); ++u)
            difference += std::abs(picture.at(u, v, 3) - disc.at(u, v) / area) / 2;
    }
    return difference;
}

}  // namespace matchlight
