// Circles, then across, then down.
#include "render/effects/defocus_two_pass.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/defocus_circles.h"

namespace matchlight {

void TwoPassKnobs::check() const {
    if (largest_radius_px < 1 || largest_radius_px > 16384)
        throw std::invalid_argument(fmt::format("largest_radius_px is {}, not from 1 to 16384", largest_radius_px));
}

TwoPassKnobs two_pass_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.largest_radius_px = 16};
        case QualityLevel::preview:
            return {.largest_radius_px = 32};
        case QualityLevel::reference:
            return {.largest_radius_px = 16384};  // as wide as any frame
        case QualityLevel::final_:
            break;
    }
    return {};
}

GraphTexture add_two_pass_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                  const TwoPassKnobs& knobs) {
    knobs.check();
    const double radius_px = std::min<double>(knobs.largest_radius_px, input.range.widest_px() / 2);
    const Region region = graph.shape(input.light).region;
    GraphTexture light = input.light, circles = add_circles(graph, shaders, input);
    for (const auto& [name, step] : {std::pair{"across", "ivec2(1, 0)"}, std::pair{"down", "ivec2(0, 1)"}}) {
        Program& program = shaders.full_screen("effects/depth_of_field/two_pass.frag", {{"STEP", step}});
        GraphPass pass;
        pass.name = fmt::format("depth of field/{}", name);
        pass.reads = {{light}, {circles}};
        pass.writes = {GL_RGBA32F, GL_RG32F};
        pass.region = region;
        pass.draw = [&program, light, circles, knobs, reach = static_cast<int>(std::ceil(radius_px))](PassRun& run) {
            program.use();
            bind_weighted(run, program, light, circles, knobs.largest_radius_px);
            program.set("reach", reach);
            run.draw(program);
        };
        const std::vector<GraphTexture> written = graph.add_pass(std::move(pass));
        light = written[0];
        circles = written[1];
    }
    return light;
}

}  // namespace matchlight
