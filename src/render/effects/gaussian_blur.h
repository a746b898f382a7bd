// A Gaussian along one axis of a texture of the graph.
#pragma once

#include <string>
#include <vector>

#include "gl/shader_library.h"
#include "render/graph.h"

namespace matchlight {

/// Weights from the middle to one side (the other is its mirror), of unit sum over both and of exactly this variance:
/// cutting and sampling change a Gaussian's variance, so another one's is sampled that has it afterwards.
std::vector<float> gaussian_taps(double variance_texels2, double cut_sigmas);

enum class BlurAxis { across, down };

struct AxisBlur {
    std::string name;
    BlurAxis axis = BlurAxis::across;
    std::vector<float> taps;  // from the middle to one side
    Region region;            // of what is written, in the light's texels; it may leave the frame
    GraphTexture wider = {};  // added as it is: of the light's scale, or of twice that
    bool full_float = false;
    const GpuCondition* needs = nullptr;
};

GraphTexture add_axis_blur(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, const AxisBlur& blur);

}  // namespace matchlight
