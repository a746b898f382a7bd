// One small pass.
#include "render/effects/defocus_circles.h"

namespace matchlight {

GraphTexture add_circles(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
    Program& program = shaders.full_screen("effects/depth_of_field/circles.frag");
    GraphPass pass;
    pass.name = "depth of field/circles";
    pass.reads = {{input.inverse_depth}};
    pass.writes = {GL_RG32F};
    pass.region = graph.shape(input.light).region;
    pass.draw = [&program, depth = input.inverse_depth, focus = input.focus](PassRun& run) {
        program.use();
        run.bind(program, "inverse_depth", 0, depth);
        program.set("coc_scale_px_m", focus.coc_scale_px_m);
        program.set("inverse_focus", 1 / focus.focus_distance_m);
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

void bind_weighted(const PassRun& run, Program& program, GraphTexture light, GraphTexture circles,
                   double largest_radius_px) {
    run.bind(program, "light", 0, light);
    run.bind(program, "circles", 1, circles);
    program.set("largest_radius_px", largest_radius_px);
    program.set("least_coc_px", least_coc_px);
}

}  // namespace matchlight
