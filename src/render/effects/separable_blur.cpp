// Across, then down; light and coverage together.
#include "render/effects/separable_blur.h"

#include <span>

#include "render/effects/gaussian_blur.h"

namespace matchlight {

namespace {

PlateLayer add_axis(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer, const std::vector<float>& taps,
                    BlurAxis axis, const std::string& name) {
    ShaderDefines defines{{"RADIUS", std::to_string(taps.size() - 1)},
                          {"STEP", axis == BlurAxis::across ? "ivec2(1, 0)" : "ivec2(0, 1)"}};
    std::vector<GLenum> writes{GL_RGBA32F};
    if (layer.coverage) {
        defines["COVERAGE"] = "1";
        writes.push_back(GL_RGBA32F);
    }
    const GraphTexture light = layer.light, coverage = layer.coverage;
    const std::vector<GraphTexture> written =
        graph.add_pass({.name = name + (axis == BlurAxis::across ? "/across" : "/down"),
                        .reads = {{light}, {coverage}},
                        .writes = writes,
                        .region = graph.shape(light).region,
                        .draw = [&shaders, light, coverage, taps, defines](PassRun& run) {
                            Program& program = shaders.full_screen("effects/separable_blur/blur.frag", defines);
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

}  // namespace

PlateLayer add_separable_blur(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                              const std::vector<float>& taps, const std::string& name) {
    const PlateLayer across = add_axis(graph, shaders, layer, taps, BlurAxis::across, name);
    return add_axis(graph, shaders, across, taps, BlurAxis::down, name);
}

}  // namespace matchlight
