// The chain of squares.
#include "render/effects/bloom_classic.h"

#include <algorithm>

#include <fmt/format.h>

#include "render/effects/bright_pass.h"
#include "render/effects/gaussian_blur.h"
#include "render/effects/squeezed_square.h"

namespace matchlight {

GraphTexture add_classic_bloom(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                               const BloomSettings& settings, const BloomKnobs& knobs, double object_strength,
                               GpuCondition& bright) {
    const Region frame = graph.frame();
    // A texel of the first square is no finer than these.
    int scale = 1;
    while (std::min(frame.width, frame.height) >= 2 * scale * classic_bloom_sizes[0]) scale *= 2;
    BrightPassSettings spills = bloom_light(settings, object_strength);
    spills.full_float = knobs.full_float;
    const GraphTexture bright_light = add_bright_pass(graph, shaders, light, spills, scale, bright);
    if (!bright_light) return {};

    const double sigma = classic_bloom_sigma_texels(settings);
    AxisBlur blur;
    blur.taps = gaussian_taps(sigma * sigma, knobs.cut_sigmas);
    blur.full_float = knobs.full_float;
    blur.needs = &bright;
    const int radius = static_cast<int>(blur.taps.size()) - 1;
    SqueezePass pass{.name = {}, .full_float = knobs.full_float, .needs = &bright};
    std::vector<SqueezedSquare> squares;
    for (const int size : classic_bloom_sizes) {
        pass.name = fmt::format("bloom/squeeze {}", size);
        SqueezedSquare square = squares.empty() ? add_squeezed(graph, shaders, bright_light, size, pass)
                                                : add_squeezed(graph, shaders, squares.back(), size, pass);
        const Region lit = graph.shape(square.texture).region;
        blur.name = fmt::format("bloom/across {}", size);
        blur.axis = BlurAxis::across;
        blur.region = lit.grown(radius).intersected({0, lit.y, size, lit.height});
        square.texture = add_axis_blur(graph, shaders, square.texture, blur);
        blur.name = fmt::format("bloom/down {}", size);
        blur.axis = BlurAxis::down;
        blur.region = lit.grown(radius).intersected(square.bounds());
        square.texture = add_axis_blur(graph, shaders, square.texture, blur);
        squares.push_back(square);
    }
    pass.name = "bloom/magnify";
    return add_magnified(graph, shaders, squares, settings.strength / static_cast<double>(squares.size()), pass);
}

}  // namespace matchlight
