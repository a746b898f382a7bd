// Circles, then the gather.
#include "render/effects/defocus_one_pass.h"

#include <algorithm>
#include <memory>

#include "render/effects/defocus_circles.h"

namespace matchlight {

OnePassKnobs one_pass_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.rings = 4, .ring_samples = 8, .largest_radius_px = 16};
        case QualityLevel::preview:
            return {.rings = 8, .ring_samples = 16, .largest_radius_px = 32};
        case QualityLevel::reference:
            return {.rings = 64, .ring_samples = 128, .largest_radius_px = 16384};  // as wide as any frame
        case QualityLevel::final_:
            break;
    }
    return {};
}

GraphTexture add_one_pass_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                  const OnePassKnobs& knobs) {
    knobs.check();
    const double radius_px = std::min<double>(knobs.largest_radius_px, input.range.widest_px() / 2);
    const std::vector<DefocusTap> taps = ring_taps(radius_px, knobs);
    const auto buffer = std::make_shared<Buffer>(std::span<const DefocusTap>(taps));
    const GraphTexture circles = add_circles(graph, shaders, input);
    Program& program = shaders.full_screen("effects/depth_of_field/one_pass.frag");
    GraphPass pass;
    pass.name = "depth of field/one pass";
    pass.reads = {{input.light}, {circles}};
    pass.writes = {GL_RGBA32F};
    pass.region = graph.shape(input.light).region;
    pass.draw = [&program, light = input.light, circles, knobs, buffer, count = taps.size()](PassRun& run) {
        program.use();
        bind_weighted(run, program, light, circles, knobs.largest_radius_px);
        buffer->bind(GL_SHADER_STORAGE_BUFFER, 0);
        program.set("tap_count", static_cast<int>(count));
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

}  // namespace matchlight
