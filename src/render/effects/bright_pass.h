// The bright pass: how much light above a threshold virtual things add to a frame, or take away from it.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/bright_light.h"
#include "render/frame_light.h"

namespace matchlight {

/// Writes D = bright(after) · (object_strength in the share a that objects send) − bright(before), one texel
/// for `scale` × `scale` frame pixels: the threshold first, then the mean, so that D's sum does not depend on the
/// scale. `objects` takes bright(after) · a · object_strength alone, `rest` what is left of D then. Pixels outside of
/// the frame are dark. Channels are held to ±65504, NaN counts as 0. Meets `bright` where any D is not 0. A
/// firefly-safe pass wants a scale of 1, 2, or a multiple of 4.
GraphTexture add_bright_pass(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                             const BrightPassSettings& settings, int scale, GpuCondition& bright);

}  // namespace matchlight
