// What all effects of bright light add to a frame, summed: the study's equation 9 but for the picture itself.
#pragma once

#include <vector>

#include "gl/condition.h"
#include "gl/shader_library.h"
#include "render/graph.h"

namespace matchlight {

/// One effect's light, valid where its condition is met.
struct SpillPart {
    GraphTexture light;  // plate-linear, signed; RGB
    const GpuCondition* condition = nullptr;
};

/// The sum, at the finest scale of the parts; zero where no condition is met. Empty when there are no parts.
GraphTexture add_spill_sum(RenderGraph& graph, ShaderLibrary& shaders, const std::vector<SpillPart>& parts);

/// The most that the sum changes within each tile of `tile_px` frame pixels, one texel a tile (R32F): what says, once
/// it is read back with the picture, where the surroundings of objects need drawing.
GraphTexture add_spill_tiles(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture sum, int tile_px);

}  // namespace matchlight
