// One pass over the region: each plate pixel looks at the layer pixels that it spans.
#include "render/exchange_layers.h"

#include <cassert>

namespace matchlight {

ExchangeLayers add_exchange_layers(RenderGraph& graph, ShaderLibrary& shaders, const CompositePass& composite,
                                   const CompositeInput& input) {
    assert(input.layer != nullptr);
    const std::vector<GraphTexture> written =
        graph.add_pass({.name = "exchange",
                        .reads = {{input.layer_drawn}},
                        .writes = std::vector<GLenum>(5, GL_RGBA32F),
                        .region = input.region,
                        .draw = [&shaders, &composite, input](PassRun& run) {
                            const VirtualLayer& layer = *input.layer;
                            Program& program =
                                shaders.full_screen("composite/exchange.frag", CompositePass::layer_defines(input));
                            program.use();
                            composite.set_layer(program, input);
                            program.bind_texture("way_to_next", 10, *layer.way_to_next);
                            program.bind_texture("way_to_previous", 11, *layer.way_to_previous);
                            program.bind_texture("layer_parts", 14, *layer.parts);
                            program.set("sample_count", layer.parts->shape().samples);
                            run.draw(program);
                        }});
    return {.motion = written[0], .parts = {written[1], written[2], written[3], written[4]}};
}

}  // namespace matchlight
