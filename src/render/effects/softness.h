// The softness of recorded footage: what codec and resampling blur, as a Gaussian on plate pixels.
#pragma once

#include "gl/shader_library.h"
#include "render/graph.h"
#include "render/virtual_layer.h"
#include "scene/scene_file.h"

namespace matchlight {

/// A Gaussian of a smaller standard deviation is none: across and down it moves 4 % of a pixel's light to its
/// neighbours, and its variance is half of what the pixel's own box has (1/12 px²).
inline constexpr double least_softness_px = 0.2;

struct SoftnessKnobs {
    double cut_sigmas = 3;  // where the Gaussian ends; its variance is kept all the same
};
SoftnessKnobs softness_knobs(QualityLevel level);

/// How far it moves light, in plate pixels.
int softness_reach_px(double sigma_px, const SoftnessKnobs& knobs);

/// Light and coverage blurred. Beyond the frame's edge the layer goes on as it ends there, as for a codec.
PlateLayer add_softness(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer, double sigma_px,
                        const SoftnessKnobs& knobs);

}  // namespace matchlight
