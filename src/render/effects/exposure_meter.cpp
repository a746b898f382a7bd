// One pass; every texel sums its own block, so the order of summing never changes.
#include "render/effects/exposure_meter.h"

#include <algorithm>

#include "render/effects/exposure.h"

namespace matchlight {

GraphTexture add_exposure_meter(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, int block_px) {
    if (!light) return {};
    return graph.add_pass({.name = "exposure/meter",
                           .reads = {{light}},
                           .writes = {GL_RGBA32F},
                           .scale = block_px,
                           .draw = [&shaders, light](PassRun& run) {
                               Program& program = shaders.full_screen("effects/exposure/meter.frag");
                               program.use();
                               run.bind(program, "light", 0, light);
                               program.set("block_px", run.scale());
                               program.set("black_luminance", black_luminance);
                               run.draw(program);
                           }})[0];
}

int meter_block_px(int frame_width, int frame_height) {
    constexpr int longest_side = 256;
    return (std::max(frame_width, frame_height) + longest_side - 1) / longest_side;
}

}  // namespace matchlight
