// Across, then down; light and coverage together.
#include "render/effects/softness.h"

#include <span>
#include <string>
#include <vector>

#include "render/effects/gaussian_blur.h"

namespace matchlight {

namespace {

PlateLayer add_axis(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer, const std::vector<float>& taps,
                    BlurAxis axis) {
    ShaderDefines defines{{"RADIUS", std::to_string(taps.size() - 1)},
                          {"STEP", axis == BlurAxis::across ? "ivec2(1, 0)" : "ivec2(0, 1)"}};
    std::vector<GLenum> writes{GL_RGBA32F};
    if (layer.coverage) {
        defines["COVERAGE"] = "1";
        writes.push_back(GL_RGBA32F);
    }
    const GraphTexture light = layer.light, coverage = layer.coverage;
    const std::vector<GraphTexture> written =
        graph.add_pass({.name = axis == BlurAxis::across ? "softness/across" : "softness/down",
                        .reads = {{light}, {coverage}},
                        .writes = writes,
                        .region = graph.shape(light).region,
                        .draw = [&shaders, light, coverage, taps, defines](PassRun& run) {
                            Program& program = shaders.full_screen("effects/softness/blur.frag", defines);
                            program.use();
                            run.bind(program, "layer", 0, light);
                            if (coverage) run.bind(program, "coverage", 1, coverage);
                            program.set("taps", std::span<const float>(taps));
                            run.draw(program);
                        }});
    PlateLayer blurred = layer;
    blurred.light = written[0];
    if (coverage) blurred.coverage = written[1];
    return blurred;
}

std::vector<float> taps_of(double sigma_px, const SoftnessKnobs& knobs) {
    return gaussian_taps(sigma_px * sigma_px, knobs.cut_sigmas);
}

}  // namespace

SoftnessKnobs softness_knobs(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {.cut_sigmas = 1};
        case QualityLevel::preview:
            return {.cut_sigmas = 2};
        case QualityLevel::reference:
            return {.cut_sigmas = 5};
        case QualityLevel::final_:
            break;
    }
    return {};
}

int softness_reach_px(double sigma_px, const SoftnessKnobs& knobs) {
    return sigma_px < least_softness_px ? 0 : static_cast<int>(taps_of(sigma_px, knobs).size()) - 1;
}

PlateLayer add_softness(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer, double sigma_px,
                        const SoftnessKnobs& knobs) {
    if (!layer.light || sigma_px < least_softness_px) return layer;
    const std::vector<float> taps = taps_of(sigma_px, knobs);
    return add_axis(graph, shaders, add_axis(graph, shaders, layer, taps, BlurAxis::across), taps, BlurAxis::down);
}

}  // namespace matchlight
