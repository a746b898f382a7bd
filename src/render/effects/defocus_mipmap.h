// Depth of field by looking the circle of confusion up in a pyramid of blurred pictures (Lee, Kim & Choi 2009,
// "Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation").
//
// As dear for wide circles as for narrow ones; but a point becomes a soft spot, not a disc, and what is before the
// focus spreads over the plate, not over virtual things behind it. The double-precision reference is
// report/defocus_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct MipmapKnobs {
    int levels = 7;  // circles wider than 2^levels · 2.8 px are drawn as that; each is two of 16 textures

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
MipmapKnobs mipmap_knobs(QualityLevel quality);

/// RGBA32F over the input's region: premultiplied light, coverage.
GraphTexture add_mipmap_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                const MipmapKnobs& knobs);

}  // namespace matchlight
