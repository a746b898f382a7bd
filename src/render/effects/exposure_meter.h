// The meter on the GPU: a frame's luminance, reduced to a map that is small enough to be read back.
#pragma once

#include "gl/shader_library.h"
#include "render/graph.h"

namespace matchlight {

/// Reduces `light` (RGB, linear; one pixel a texel) to one texel for each block of `block_px` pixels a side: r = Σ log₂
/// L over its pixels that are neither black (render/effects/exposure.h) nor non-finite, g = their number, b = their
/// greatest log₂ L. L is luminance by Rec.709. RGBA32F; empty where `light` is.
GraphTexture add_exposure_meter(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, int block_px);

/// Pixels along a side of a block so that the map of a frame has at most 256 texels along its longer side.
int meter_block_px(int frame_width, int frame_height);

}  // namespace matchlight
