// Circles of confusion as a texture, and the uniforms of the weights that use them.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "render/graph.h"

namespace matchlight {

/// RG32F over the light's region: signed circle in px, and 1 where something is.
GraphTexture add_circles(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input);

/// Binds what effects/depth_of_field/weights.glsl reads, in units 0 and 1.
void bind_weighted(const PassRun& run, Program& program, GraphTexture light, GraphTexture circles,
                   double largest_radius_px);

}  // namespace matchlight
