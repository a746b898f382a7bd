// Lines across, then down, as often as there are steps.
#include "render/effects/defocus_diffusion.h"

#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/defocus_circles.h"

namespace matchlight {

namespace {

constexpr int lines_in_group = 16;  // of the shader

struct Diffusing {
    GraphTexture light, circles;
};

Diffusing add_lines(RenderGraph& graph, ShaderLibrary& shaders, const Diffusing& from, bool across, int steps) {
    Program& program =
        shaders.compute("effects/depth_of_field/diffusion.comp", {{"STEP", across ? "ivec2(1, 0)" : "ivec2(0, 1)"}});
    const Region region = graph.shape(from.light).region;
    const Eigen::Vector2i line_size =
        across ? Eigen::Vector2i(region.width, region.height) : Eigen::Vector2i(region.height, region.width);
    GraphPass pass;
    pass.name = across ? "depth of field/diffused across" : "depth of field/diffused down";
    pass.reads = {{from.light}, {from.circles}};
    pass.writes = {GL_RGBA32F, GL_RG32F, GL_R32F};
    pass.region = region;
    pass.raster = false;
    pass.draw = [&program, from, line_size, steps](PassRun& run) {
        program.use();
        run.bind(program, "light", 0, from.light);
        run.bind(program, "circles", 1, from.circles);
        program.set("line_size", line_size);
        program.set("steps", static_cast<float>(steps));
        program.set("least_coc_px", least_coc_px);
        for (const GLuint unit : {0U, 1U, 2U}) run.written(unit).bind_image(unit, GL_READ_WRITE);
        const int groups = (line_size.y() + lines_in_group - 1) / lines_in_group;
        glDispatchCompute(static_cast<GLuint>(groups), 1, 1);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                        GL_TEXTURE_UPDATE_BARRIER_BIT);
    };
    const std::vector<GraphTexture> written = graph.add_pass(std::move(pass));
    return {written[0], written[1]};
}

}  // namespace

void DiffusionKnobs::check() const {
    if (steps < 1 || steps > 64) throw std::invalid_argument(fmt::format("steps is {}, not from 1 to 64", steps));
}

DiffusionKnobs diffusion_knobs(QualityLevel quality) {
    return {.steps = quality == QualityLevel::reference ? 8 : 1};
}

GraphTexture add_diffusion_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                   const DiffusionKnobs& knobs) {
    knobs.check();
    Diffusing state{input.light, add_circles(graph, shaders, input)};
    for (int step = 0; step < knobs.steps; ++step) {
        state = add_lines(graph, shaders, state, true, knobs.steps);
        state = add_lines(graph, shaders, state, false, knobs.steps);
    }
    return state.light;
}

}  // namespace matchlight
