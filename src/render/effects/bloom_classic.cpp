// The chain of squares: their texels are not the frame's, so each pass says its own region.
#include "render/effects/bloom_classic.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/effects/bright_pass.h"
#include "render/effects/gaussian_blur.h"

namespace matchlight {
namespace {

/// Texels of a square of `size` that a frame's pixels fall on.
Region squeezed(const Region& pixels, const Region& frame, int size) {
    const auto low = [&](int at, int of) { return static_cast<int>(std::floor(double(at) * size / of)); };
    const auto high = [&](int at, int of) { return static_cast<int>(std::ceil(double(at) * size / of)); };
    const int left = low(pixels.x, frame.width), top = low(pixels.y, frame.height);
    return {left, top, high(pixels.x + pixels.width, frame.width) - left,
            high(pixels.y + pixels.height, frame.height) - top};
}

/// Pixels that texels of the square reach by interpolation.
Region magnified(const Region& texels, const Region& frame, int size) {
    const Region wide = texels.grown(1);
    const int left = wide.x * frame.width / size - 1, top = wide.y * frame.height / size - 1;
    return {left, top, (wide.x + wide.width) * frame.width / size + 2 - left,
            (wide.y + wide.height) * frame.height / size + 2 - top};
}

class Squares {
public:
    Squares(RenderGraph& graph, ShaderLibrary& shaders, const BloomKnobs& knobs, const GpuCondition& bright)
        : graph_(graph), shaders_(shaders), knobs_(knobs), bright_(bright) {}

    /// The mean of `source` over each texel of a square that covers the frame. `source_size` is the number of its own
    /// texels that cover the frame.
    GraphTexture add_squeezed(GraphTexture source, const Eigen::Vector2f& source_size, int size, const Region& region) {
        GraphPass pass = new_pass(fmt::format("bloom/classic squeeze {}", size), region);
        pass.reads = {{source}};
        Program& program = shaders_.full_screen("effects/bloom/squeeze.frag");
        const Eigen::Vector2f footprint = source_size / static_cast<float>(size);
        pass.draw = [&program, source, footprint](PassRun& run) {
            program.use();
            run.bind(program, "source", 0, source);
            program.set("footprint", footprint);
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

    GraphTexture add_blurred(GraphTexture square, int size, const std::vector<float>& taps) {
        AxisBlur blur;
        blur.taps = taps;
        blur.full_float = knobs_.full_float;
        blur.needs = &bright_;
        const int radius = static_cast<int>(taps.size()) - 1;
        const Region lit = graph_.shape(square).region;
        blur.name = fmt::format("bloom/classic across {}", size);
        blur.region = lit.grown(radius).intersected({0, lit.y, size, lit.height});
        const GraphTexture across = add_axis_blur(graph_, shaders_, square, blur);
        blur.name = fmt::format("bloom/classic down {}", size);
        blur.axis = BlurAxis::down;
        blur.region = lit.grown(radius).intersected({0, 0, size, size});
        return add_axis_blur(graph_, shaders_, across, blur);
    }

    GraphTexture add_sum(const std::vector<GraphTexture>& squares, double weight) {
        const Region frame = graph_.frame();
        int scale = 1;
        while (std::min(frame.width, frame.height) >= 2 * scale * classic_bloom_sizes[1]) scale *= 2;
        Region reached_px;
        for (std::size_t i = 0; i < squares.size(); ++i) {
            reached_px = reached_px.united(
                magnified(graph_.shape(squares[i]).region, frame, classic_bloom_sizes[i]).intersected(frame));
        }
        const GraphTexture pixels = graph_.import(nullptr, {GL_NONE, reached_px, 1});
        GraphPass pass = new_pass("bloom/classic sum", graph_.reached({pixels}, scale).grown(1));
        pass.scale = scale;
        for (const GraphTexture square : squares) pass.reads.push_back({square});
        Program& program = shaders_.full_screen("effects/bloom/squares.frag");
        pass.draw = [&program, squares, weight, frame, scale](PassRun& run) {
            program.use();
            for (std::size_t i = 0; i < squares.size(); ++i) {
                run.bind(program, fmt::format("square{}", i), static_cast<GLuint>(i), squares[i]);
                program.set(fmt::format("size{}", i), static_cast<float>(classic_bloom_sizes[i]));
            }
            program.set("texel_share", Eigen::Vector2f(static_cast<float>(scale) / static_cast<float>(frame.width),
                                                       static_cast<float>(scale) / static_cast<float>(frame.height)));
            program.set("weight", weight);
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

private:
    GraphPass new_pass(std::string name, const Region& region) const {
        GraphPass pass;
        pass.name = std::move(name);
        pass.writes = {knobs_.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
        pass.region = region;
        pass.beyond_frame = true;
        pass.needs = &bright_;
        return pass;
    }

    RenderGraph& graph_;
    ShaderLibrary& shaders_;
    const BloomKnobs& knobs_;
    const GpuCondition& bright_;
};

}  // namespace

GraphTexture add_classic_bloom(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                               const BloomSettings& settings, const BloomKnobs& knobs, double object_strength,
                               GpuCondition& bright) {
    const Region frame = graph.frame();
    // A texel of the first square is the mean of at least two by two of these.
    int scale = 1;
    while (std::min(frame.width, frame.height) >= 4 * scale * classic_bloom_sizes[0]) scale *= 2;
    BrightPassSettings spills = bloom_light(settings, object_strength);
    spills.full_float = knobs.full_float;
    const GraphTexture bright_light = add_bright_pass(graph, shaders, light, spills, scale, bright);
    if (!bright_light) return {};

    const double sigma = classic_bloom_sigma_texels(settings);
    const std::vector<float> taps = gaussian_taps(sigma * sigma, knobs.cut_sigmas);
    Squares squares(graph, shaders, knobs, bright);
    std::vector<GraphTexture> blurred;
    GraphTexture source = bright_light;
    Eigen::Vector2f source_size =
        Eigen::Vector2f(static_cast<float>(frame.width), static_cast<float>(frame.height)) / static_cast<float>(scale);
    Region region = squeezed(graph.shape(bright_light).frame_pixels(), frame, classic_bloom_sizes[0])
                        .intersected({0, 0, classic_bloom_sizes[0], classic_bloom_sizes[0]});
    for (const int size : classic_bloom_sizes) {
        if (!blurred.empty()) {
            const int larger = static_cast<int>(source_size.x());
            region = squeezed(graph.shape(source).region, {0, 0, larger, larger}, size);
        }
        const GraphTexture square = squares.add_squeezed(source, source_size, size, region);
        source = squares.add_blurred(square, size, taps);
        source_size = Eigen::Vector2f::Constant(static_cast<float>(size));
        blurred.push_back(source);
    }
    return squares.add_sum(blurred, settings.strength / static_cast<double>(blurred.size()));
}

}  // namespace matchlight
