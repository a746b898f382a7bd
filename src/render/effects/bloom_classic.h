// Bloom as games had it first: the picture squeezed into squares of 512, 256 and 64 texels, blurred in each.
#pragma once

#include "render/effects/bloom.h"

namespace matchlight {

/// bloom_model.h says its widths. The picture is squeezed into the largest square by area, blurred by a separable
/// Gaussian, reduced, blurred again, and so on; the three blurred squares weigh the same. As in the study this follows,
/// but for two things: the threshold has a knee, and the squares are interpolated bilinearly at whatever resolution.
GraphTexture add_classic_bloom(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                               const BloomSettings& settings, const BloomKnobs& knobs, double object_strength,
                               GpuCondition& bright);

}  // namespace matchlight
