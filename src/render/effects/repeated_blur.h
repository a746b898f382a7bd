// A box along rows and columns, again and again, over the virtual layer.
#pragma once

#include "gl/shader_library.h"
#include "render/graph.h"
#include "render/virtual_layer.h"
#include "scene/color_transform.h"
#include "scene/scene_file.h"

namespace matchlight {

/// The same variance in fewer passes of a Gaussian, cut off: draft and preview. Final and reference: the boxes.
struct RepeatedBlurKnobs {
    double cut_sigmas = 0;  // 0: box by box
};
RepeatedBlurKnobs repeated_blur_knobs(QualityLevel level);

/// How far it moves light, in plate pixels.
int repeated_blur_reach_px(const RepeatedBlurSettings& settings, const RepeatedBlurKnobs& knobs);

/// Light and coverage blurred; a box of one pixel changes nothing.
PlateLayer add_repeated_blur(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                             const RepeatedBlurSettings& settings, const RepeatedBlurKnobs& knobs);

}  // namespace matchlight
