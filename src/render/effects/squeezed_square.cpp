// Their texels are not the frame's: each pass says its own region.
#include "render/effects/squeezed_square.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace matchlight {
namespace {

/// Of a texture, along both axes: how many of its texels cover the frame.
using CoverSize = Eigen::Vector2d;

/// Texels of a square of `size` that texels of the source fall on.
Region squeezed(const Region& texels, const CoverSize& source, int size) {
    const Eigen::Vector2d scale = source.cwiseInverse() * size;
    const int left = static_cast<int>(std::floor(texels.x * scale.x()));
    const int top = static_cast<int>(std::floor(texels.y * scale.y()));
    const int right = static_cast<int>(std::ceil((texels.x + texels.width) * scale.x()));
    const int bottom = static_cast<int>(std::ceil((texels.y + texels.height) * scale.y()));
    return Region{left, top, right - left, bottom - top}.intersected({0, 0, size, size});
}

GraphPass new_pass(const SqueezePass& settings, const Region& region) {
    GraphPass pass;
    pass.name = settings.name;
    pass.writes = {settings.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
    pass.region = region;
    pass.beyond_frame = true;
    pass.needs = settings.needs;
    return pass;
}

SqueezedSquare add_mean(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, const CoverSize& source,
                        int size, const SqueezePass& settings) {
    GraphPass pass = new_pass(settings, squeezed(graph.shape(light).region, source, size));
    pass.reads = {{light}};
    Program& program = shaders.full_screen("effects/squeezed_square/squeeze.frag");
    pass.draw = [&program, light, footprint = Eigen::Vector2f((source / size).cast<float>())](PassRun& run) {
        program.use();
        run.bind(program, "source", 0, light);
        program.set("footprint", footprint);
        run.draw(program);
    };
    return {graph.add_pass(std::move(pass)).front(), size};
}

}  // namespace

SqueezedSquare add_squeezed(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, int size,
                            const SqueezePass& pass) {
    const Region frame = graph.frame();
    return add_mean(graph, shaders, light, CoverSize(frame.width, frame.height) / graph.shape(light).scale, size, pass);
}

SqueezedSquare add_squeezed(RenderGraph& graph, ShaderLibrary& shaders, const SqueezedSquare& square, int size,
                            const SqueezePass& pass) {
    return add_mean(graph, shaders, square.texture, CoverSize::Constant(square.size), size, pass);
}

GraphTexture add_magnified(RenderGraph& graph, ShaderLibrary& shaders, const std::vector<SqueezedSquare>& squares,
                           double weight, const SqueezePass& settings) {
    assert(!squares.empty() && squares.size() <= 3);
    const Region frame = graph.frame();
    int finest = 0;
    Region reached_px;
    for (const SqueezedSquare& square : squares) {
        finest = std::max(finest, square.size);
        // Interpolation reaches half a texel further.
        const Region wide = graph.shape(square.texture).region.grown(1).intersected(square.bounds());
        const Eigen::Vector2d texel_px = Eigen::Vector2d(frame.width, frame.height) / square.size;
        const int left = static_cast<int>(std::floor(wide.x * texel_px.x()));
        const int top = static_cast<int>(std::floor(wide.y * texel_px.y()));
        reached_px =
            reached_px.united({left, top, static_cast<int>(std::ceil((wide.x + wide.width) * texel_px.x())) - left,
                               static_cast<int>(std::ceil((wide.y + wide.height) * texel_px.y())) - top});
    }
    // Two texels written to one of the finest square along the frame's shorter side.
    int scale = 1;
    while (std::min(frame.width, frame.height) >= 4 * scale * finest) scale *= 2;
    const GraphTexture pixels = graph.import(nullptr, {GL_NONE, reached_px, 1});
    GraphPass pass = new_pass(settings, graph.reached({pixels}, scale).grown(1));
    pass.scale = scale;
    for (const SqueezedSquare& square : squares) pass.reads.push_back({square.texture});
    Program& program =
        shaders.full_screen("effects/squeezed_square/magnify.frag", {{"SQUARES", std::to_string(squares.size())}});
    const Eigen::Vector2f texel_share(static_cast<float>(scale) / static_cast<float>(frame.width),
                                      static_cast<float>(scale) / static_cast<float>(frame.height));
    pass.draw = [&program, squares, weight, texel_share](PassRun& run) {
        program.use();
        for (std::size_t i = 0; i < squares.size(); ++i) {
            run.bind(program, fmt::format("square{}", i), static_cast<GLuint>(i), squares[i].texture);
            program.set(fmt::format("size{}", i), static_cast<float>(squares[i].size));
        }
        program.set("texel_share", texel_share);
        program.set("weight", weight);
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

}  // namespace matchlight
