// Adds by blending into a dark texture, each part under its own condition.
#include "render/effects/spill.h"

#include <algorithm>

namespace matchlight {

GraphTexture add_spill_sum(RenderGraph& graph, ShaderLibrary& shaders, const std::vector<SpillPart>& parts) {
    GraphPass pass{.name = "spill/sum", .writes = {GL_RGBA16F}};
    std::vector<SpillPart> present;
    for (const SpillPart& part : parts) {
        if (!part.light) continue;
        const int scale = graph.shape(part.light).scale;
        pass.scale = present.empty() ? scale : std::min(pass.scale, scale);
        pass.reads.push_back({part.light});
        present.push_back(part);
    }
    if (present.empty()) return {};
    pass.draw = [&shaders, present](PassRun& run) {
        run.target().clear_color(0, 0, 0, 0, 0);
        Program& program = shaders.full_screen("effects/spill/sum.frag");
        program.use();
        program.set("target_scale", run.scale());
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        for (const SpillPart& part : present) {
            run.bind(program, "source", 0, part.light);
            run.draw_if(*part.condition, program);
        }
        glDisable(GL_BLEND);
    };
    return graph.add_pass(std::move(pass))[0];
}

GraphTexture add_spill_tiles(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture sum, int tile_px) {
    if (!sum) return {};
    return graph.add_pass({.name = "spill/tiles",
                           .reads = {{sum, 1}},
                           .writes = {GL_R32F},
                           .scale = tile_px,
                           .draw = [&shaders, sum](PassRun& run) {
                               Program& program = shaders.full_screen("effects/spill/tiles.frag");
                               program.use();
                               program.set("target_scale", run.scale());
                               run.bind(program, "spill", 0, sum);
                               run.draw(program);
                           }})[0];
}

}  // namespace matchlight
