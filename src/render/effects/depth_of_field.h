// Depth of field: what is not at the lens' focus distance becomes a disc of the circle of confusion.
//
// Every method but `lens_samples` (which draws the scene from many points of the lens) blurs the virtual layer on plate
// pixels, premultiplied with its coverage, and leaves the plate alone: it is known behind the objects, and carries the
// lens' own blur already.
#pragma once

#include "calibration/thin_lens.h"
#include "gl/shader_library.h"
#include "render/graph.h"
#include "scene/effects.h"

namespace matchlight {

/// Signed circles of confusion (thin_lens.h: negative before the focus) over all that a layer shows, in plate pixels.
struct CocRange {
    double nearest_px = 0;   // of what is closest to the lens: the least
    double farthest_px = 0;  // the greatest

    double widest_px() const;
    /// No circle is as wide as least_coc_px: everything stays as it is.
    bool is_sharp() const { return widest_px() < least_coc_px; }
    void extend(const CocRange& other);
};

/// What the methods that work on a single picture of the layer blur. Both textures cover one region, which has room
/// around the objects for their blur.
struct DefocusInput {
    GraphTexture light;          // RGBA32F: premultiplied radiance in probe units, a = coverage
    GraphTexture inverse_depth;  // R32F: 1/m of what is nearest in the pixel, 0 where nothing is
    Focus focus;                 // signed circle in px: scale · (1/focus distance − inverse_depth)
    CocRange range;
    BokehSettings bokeh;
};

}  // namespace matchlight
