// Depth of field by one gather over the disc, its samples on rings, with the weights of `two_pass`.
//
// Circular, unlike that; but rings leave gaps, in which a small highlight is missed or counted for all of them. The
// double-precision reference is report/defocus_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/defocus_taps.h"
#include "render/effects/depth_of_field.h"
#include "scene/scene_file.h"

namespace matchlight {

OnePassKnobs one_pass_knobs(QualityLevel quality);

/// RGBA32F over the input's region: premultiplied light, coverage.
GraphTexture add_one_pass_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                  const OnePassKnobs& knobs);

}  // namespace matchlight
