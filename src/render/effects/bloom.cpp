// Plans the pyramid: which Gaussian on which level, and how much blur each still wants there.
#include "render/effects/bloom.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/bloom_classic.h"
#include "render/effects/bright_pass.h"
#include "render/effects/gaussian_blur.h"

namespace matchlight {
namespace {

/// Variances in texels² of the finer level: of a step down or up by [1 3 3 1].
constexpr double variance_of_step = 0.75;

/// Of the mean over scale² pixels, in pixels².
double variance_of_mean(int scale) {
    return (scale * scale - 1) / 12.0;
}
/// Of linear interpolation between texels of `scale` pixels, in pixels².
double variance_of_interpolation(int scale) {
    return scale == 1 ? 0 : (2 * scale * scale + 1) / 12.0;
}

/// Texels of the next level that the texels of `region` send light to by [1 3 3 1].
Region reduced(const Region& region) {
    const auto half = [](int value) { return value >> 1; };  // rounds down below 0 too
    const int left = half(region.x - 1), top = half(region.y - 1);
    return {left, top, half(region.x + region.width) + 1 - left, half(region.y + region.height) + 1 - top};
}

class Pyramid {
public:
    Pyramid(RenderGraph& graph, ShaderLibrary& shaders, const BloomKnobs& knobs, const GpuCondition& bright)
        : graph_(graph), shaders_(shaders), knobs_(knobs), bright_(bright) {}

    GraphTexture add(GraphTexture light, std::vector<BloomGaussian> gaussians) {
        const int scale = graph_.shape(light).scale;
        reach_px_ = static_cast<int>(std::ceil(knobs_.cut_sigmas * gaussians.front().sigma_px));
        light_ = light;
        // Widest first: from the coarsest level to the finest.
        std::vector<int> levels;
        for (const BloomGaussian& gaussian : gaussians) {
            const double fits = gaussian.sigma_px / (knobs_.sigma_texels * scale);
            levels.push_back(fits < 2 ? 0 : static_cast<int>(std::floor(std::log2(fits))));
        }
        std::vector<GraphTexture> reduced_light{light};
        for (int level = 1; level <= levels.front(); ++level) {
            reduced_light.push_back(add_reduction(reduced_light.back(), level));
        }
        GraphTexture sum;
        for (std::size_t k = 0; k < gaussians.size(); ++k) {
            const double had = variance_down_px2(scale, levels[k]) + variance_up_px2(scale, levels.back(), levels[k]);
            const double texel_px = scale << levels[k];
            const double wanted =
                std::max(0.0, (gaussians[k].sigma_px * gaussians[k].sigma_px - had) / (texel_px * texel_px));
            sum = add_blurred(reduced_light[static_cast<std::size_t>(levels[k])], sum, wanted, gaussians[k].weight);
        }
        return sum;
    }

private:
    static double variance_down_px2(int scale, int level) {
        double variance = variance_of_mean(scale);
        for (int i = 0; i < level; ++i) variance += variance_of_step * std::exp2(2 * i) * scale * scale;
        return variance;
    }
    static double variance_up_px2(int scale, int finest, int level) {
        double variance = variance_of_interpolation(scale << finest);
        for (int i = finest; i < level; ++i) variance += variance_of_step * std::exp2(2 * i) * scale * scale;
        return variance;
    }

    GraphTexture add_reduction(GraphTexture finer, int level) {
        Program& program = shaders_.full_screen("effects/bloom/reduce.frag");
        const GraphShape& shape = graph_.shape(finer);
        GraphPass pass;
        pass.name = fmt::format("bloom/reduce {}", level);
        pass.reads = {{finer, 1}};
        pass.writes = {knobs_.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
        pass.scale = shape.scale * 2;
        pass.region = reduced(shape.region);
        // Light that a step down carries over the frame's edge comes back with the step up.
        pass.beyond_frame = true;
        pass.needs = &bright_;
        pass.draw = [&program, finer](PassRun& run) {
            program.use();
            run.bind(program, "source", 0, finer);
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

    /// weight · (light blurred both ways) + what the wider Gaussians came to.
    GraphTexture add_blurred(GraphTexture light, GraphTexture wider, double variance_texels2, double weight) {
        const GraphShape shape = graph_.shape(light);
        AxisBlur blur;
        blur.taps = gaussian_taps(variance_texels2, knobs_.cut_sigmas);
        blur.full_float = knobs_.full_float;
        blur.needs = &bright_;
        const int radius = static_cast<int>(blur.taps.size()) - 1;
        // A texel more than the frame has: who magnifies this interpolates towards it.
        const Region target = graph_.reached({light_, reach_px_ / shape.scale + 1}, shape.scale).grown(1);
        const Region columns{target.x, shape.region.y, target.width, shape.region.height};
        blur.name = fmt::format("bloom/across {}", shape.scale);
        blur.axis = BlurAxis::across;
        blur.region = columns.intersected(shape.region.grown(radius)).intersected(target.grown(radius));
        const GraphTexture across = add_axis_blur(graph_, shaders_, light, blur);
        blur.name = fmt::format("bloom/down {}", shape.scale);
        blur.axis = BlurAxis::down;
        blur.region = target;
        blur.wider = wider;
        for (float& tap : blur.taps) tap *= static_cast<float>(weight);
        return add_axis_blur(graph_, shaders_, across, blur);
    }

    RenderGraph& graph_;
    ShaderLibrary& shaders_;
    const BloomKnobs& knobs_;
    const GpuCondition& bright_;
    GraphTexture light_;
    int reach_px_ = 0;
};

}  // namespace

void BloomKnobs::check() const {
    if (largest_scale != 1 && largest_scale != 2 && largest_scale != 4 && largest_scale != 8) {
        throw std::invalid_argument(fmt::format("bloom's largest_scale is {}, not 1, 2, 4 or 8", largest_scale));
    }
    if (!(sigma_texels >= 0.75 && sigma_texels <= 64)) {
        throw std::invalid_argument(fmt::format("bloom's sigma_texels is {}, not from 0.75 to 64", sigma_texels));
    }
    if (!(cut_sigmas >= 1 && cut_sigmas <= 8)) {
        throw std::invalid_argument(fmt::format("bloom's cut_sigmas is {}, not from 1 to 8", cut_sigmas));
    }
    if (gaussians < 1 || gaussians > 5) {
        throw std::invalid_argument(fmt::format("bloom's gaussians is {}, not from 1 to 5", gaussians));
    }
}

BloomKnobs bloom_knobs(const BloomSettings& settings, QualityLevel quality) {
    constexpr BloomKnobs finest{.largest_scale = 1, .sigma_texels = 4, .cut_sigmas = 4, .full_float = true};
    if (settings.level == BloomLevel::reference) return finest;
    switch (quality) {
        case QualityLevel::draft:
            return {.sigma_texels = 0.75, .cut_sigmas = 2.5, .gaussians = 3};
        case QualityLevel::preview:
            return {.sigma_texels = 0.75, .cut_sigmas = 2.5, .gaussians = 4};
        case QualityLevel::reference:
            return finest;
        case QualityLevel::final_:
            break;
    }
    return {};
}

GraphTexture add_bloom(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                       const BloomSettings& settings, const BloomKnobs& knobs, double object_strength,
                       GpuCondition& bright) {
    knobs.check();
    if (settings.strength == 0) {
        graph.leave_out("bloom", "its strength is 0");
        return {};
    }
    if (settings.level == BloomLevel::classic) {
        return add_classic_bloom(graph, shaders, light, settings, knobs, object_strength, bright);
    }
    std::vector<BloomGaussian> gaussians = bloom_gaussians(settings, graph.frame().height);
    while (gaussians.size() > static_cast<std::size_t>(knobs.gaussians)) {
        gaussians[gaussians.size() - 2].weight += gaussians.back().weight;
        gaussians.pop_back();
    }
    for (BloomGaussian& gaussian : gaussians) {
        // What lies within the reach weighs as much as all of the Gaussian did.
        const double kept = std::erf(knobs.cut_sigmas * gaussians.front().sigma_px / gaussian.sigma_px / std::sqrt(2));
        gaussian.weight *= settings.strength / (kept * kept);
    }
    int scale = 1;
    while (scale < knobs.largest_scale && gaussians.back().sigma_px >= knobs.sigma_texels * scale * 2) scale *= 2;
    BrightPassSettings spills = bloom_light(settings, object_strength);
    spills.full_float = knobs.full_float;
    const GraphTexture bright_light = add_bright_pass(graph, shaders, light, spills, scale, bright);
    if (!bright_light) return {};
    return Pyramid(graph, shaders, knobs, bright).add(bright_light, std::move(gaussians));
}

}  // namespace matchlight
