// Depth of field by a blur across and one down (Zhou, Chen & Pullen 2007, "Accurate Depth of Field Simulation in Real
// Time").
//
// A disc is no product of two lines: a point out of focus becomes a square, and its share of one line where it stands
// on something else. The double-precision reference is report/defocus_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct TwoPassKnobs {
    int largest_radius_px = 64;  // wider circles are drawn as this

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
TwoPassKnobs two_pass_knobs(QualityLevel quality);

/// RGBA32F over the input's region: premultiplied light, coverage.
GraphTexture add_two_pass_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                  const TwoPassKnobs& knobs);

}  // namespace matchlight
