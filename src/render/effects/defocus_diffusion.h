// Depth of field as heat that spreads, the circles of confusion its conductivity (Kass, Lefohn & Owens 2006,
// "Interactive Depth of Field Using Simulated Diffusion").
//
// The cheapest, for wide circles as for narrow ones, and what is in focus keeps all of its light and takes none; but a
// point becomes a peak with exponential slopes, not a disc, and what is before the focus does not spread over what is
// in it. The double-precision reference is report/defocus_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct DiffusionKnobs {
    int steps = 1;  // the paper's; with more a point becomes a Gaussian

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
DiffusionKnobs diffusion_knobs(QualityLevel quality);

/// RGBA32F over the input's region: premultiplied light, coverage.
GraphTexture add_diffusion_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                   const DiffusionKnobs& knobs);

}  // namespace matchlight
