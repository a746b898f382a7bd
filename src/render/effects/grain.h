// The camera's noise on what is virtual, so that it is as grainy as the plate around it.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/grain_noise.h"
#include "render/graph.h"

namespace matchlight {

/// Noise in a part of a frame, for common use by the passes that make code values of light.
struct FrameGrain {
    GrainModel model;
    GraphTexture noise;          // RGB of variance 1
    double least_deviation = 0;  // noise of less is none
};

class GrainNoise {
public:
    explicit GrainNoise(ShaderLibrary& shaders);
    /// RGBA32F over `region`: each pixel's noise is the same whatever the region.
    GraphTexture add(RenderGraph& graph, const GrainModel& model, const Region& region);

private:
    ShaderLibrary& shaders_;
    Texture2D quantiles_;
};

/// Sets the uniforms of effects/grain/grain.glsl; takes one texture unit.
void set_grain(const PassRun& run, Program& program, GLuint unit, const FrameGrain& grain);

}  // namespace matchlight
