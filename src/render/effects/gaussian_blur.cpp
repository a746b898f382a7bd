// Finds the taps, and draws with them.
#include "render/effects/gaussian_blur.h"

#include <cassert>
#include <cmath>

namespace matchlight {

std::vector<float> gaussian_taps(double variance_texels2, double cut_sigmas) {
    const int radius = static_cast<int>(std::ceil(cut_sigmas * std::sqrt(variance_texels2)));
    if (radius == 0) return {1};
    const auto weight = [](int i, double variance) { return std::exp(-0.5 * i * i / variance); };
    const auto variance_of_taps = [&](double variance) {
        double sum = 1, squares = 0;
        for (int i = 1; i <= radius; ++i) {
            sum += 2 * weight(i, variance);
            squares += 2.0 * i * i * weight(i, variance);
        }
        return squares / sum;
    };
    // From a single tap to taps that weigh about alike: the variance grows between them all the way.
    double low = 1e-3, high = 1e3 * (variance_texels2 + 1);
    for (int step = 0; step < 60; ++step) {
        const double middle = std::sqrt(low * high);
        (variance_of_taps(middle) < variance_texels2 ? low : high) = middle;
    }
    double sum = 1;
    for (int i = 1; i <= radius; ++i) sum += 2 * weight(i, high);
    std::vector<float> taps;
    taps.reserve(static_cast<std::size_t>(radius) + 1);
    for (int i = 0; i <= radius; ++i) taps.push_back(static_cast<float>(weight(i, high) / sum));
    return taps;
}

GraphTexture add_axis_blur(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, const AxisBlur& blur) {
    const int scale = graph.shape(light).scale;
    const int radius = static_cast<int>(blur.taps.size()) - 1;
    ShaderDefines defines{{"RADIUS", std::to_string(radius)},
                          {"STEP", blur.axis == BlurAxis::across ? "ivec2(1, 0)" : "ivec2(0, 1)"}};
    if (blur.wider) {
        const int ratio = graph.shape(blur.wider).scale / scale;
        assert(ratio == 1 || ratio == 2);
        defines["WIDER"] = std::to_string(ratio);
    }
    Program& program = shaders.full_screen("effects/bloom/blur.frag", defines);
    GraphPass pass;
    pass.name = blur.name;
    pass.reads = {{light, radius}};
    if (blur.wider) pass.reads.push_back({blur.wider, 1});
    pass.writes = {blur.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
    pass.scale = scale;
    pass.region = blur.region;
    pass.beyond_frame = true;
    pass.needs = blur.needs;
    pass.draw = [&program, light, wider = blur.wider, taps = blur.taps](PassRun& run) {
        program.use();
        run.bind(program, "source", 0, light);
        if (wider) run.bind(program, "wider", 1, wider);
        program.set("taps", std::span<const float>(taps));
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

}  // namespace matchlight
