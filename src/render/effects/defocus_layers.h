// Depth of field by slices of depth, each blurred by one circle and composited back to front (Scofield 1992, "2½-D
// Depth-of-Field Simulation for Computer Animation", Graphics Gems III).
//
// What is out of focus spreads over what is behind it, and nothing else does; discs have the opening's shape. But a
// surface that runs through several slices shows their seams: each is soft where the next begins, and the plate shines
// through. Slices add up here, where Scofield's are independent of each other, which leaves much of that away. The
// double-precision reference is report/defocus_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct LayersKnobs {
    int slices = 12;
    double radius_texels = 8;  // wider circles are drawn on coarser texels
    bool disjoint = true;      // slices that share no pixel add up; false: Porter & Duff's over, as Scofield has it

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
LayersKnobs layers_knobs(QualityLevel quality);

/// RGBA32F over the input's region: premultiplied light, coverage.
GraphTexture add_layers_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                const LayersKnobs& knobs);

/// One picture before another, premultiplied, over the region of `region_of`. Disjoint ones share no pixel and add up
/// until they fill it; else `before` lets through what its coverage leaves. `behind` may be empty.
struct SliceOver {
    GraphTexture before, behind;
    GraphTexture region_of;
    bool disjoint = false;
};
GraphTexture add_slice_over(RenderGraph& graph, ShaderLibrary& shaders, const SliceOver& slices);

}  // namespace matchlight
