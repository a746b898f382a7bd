// The frame squeezed into a square texture, as the classic effects have it, and back.
#pragma once

#include <string>
#include <vector>

#include "gl/shader_library.h"
#include "render/graph.h"

namespace matchlight {

/// A square that covers the frame with `size` × `size` texels, whatever the frame's shape; the graph counts its texels
/// from the frame's corner, as pixels.
struct SqueezedSquare {
    GraphTexture texture;
    int size = 0;

    Region bounds() const { return {0, 0, size, size}; }
};

struct SqueezePass {
    std::string name;
    bool full_float = false;
    const GpuCondition* needs = nullptr;
};

/// The mean of `light` over the part of the frame that each texel covers.
SqueezedSquare add_squeezed(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, int size,
                            const SqueezePass& pass);
/// A square reduced to a smaller one.
SqueezedSquare add_squeezed(RenderGraph& graph, ShaderLibrary& shaders, const SqueezedSquare& square, int size,
                            const SqueezePass& pass);

/// weight · the sum of up to three squares, over the part of the frame that they reach, interpolated between texels.
GraphTexture add_magnified(RenderGraph& graph, ShaderLibrary& shaders, const std::vector<SqueezedSquare>& squares,
                           double weight, const SqueezePass& pass);

}  // namespace matchlight
