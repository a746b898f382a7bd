// What other programs ask of the virtual layer beside its light: motion vectors, and the coverage of each part.
#pragma once

#include <array>

#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/graph.h"

namespace matchlight {

struct ExchangeLayers {
    /// Change of x/z and y/z of the nearest object in the pixel, to the next frame and to the previous one; RGBA32F.
    GraphTexture motion;
    /// Number of a part (SurfaceRenderer::parts, from 1; 0 = none) and its coverage, twice in each texture; RGBA32F.
    std::array<GraphTexture, 4> parts;
};

/// Over the input's region; of the input the layer alone counts, which has been drawn with ways to its neighbours and
/// parts. Takes texture units 10, 11 and 14 beside those of CompositePass::set_layer.
ExchangeLayers add_exchange_layers(RenderGraph& graph, ShaderLibrary& shaders, const CompositePass& composite,
                                   const CompositeInput& input);

}  // namespace matchlight
