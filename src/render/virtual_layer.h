// The virtual objects as drawn, and as they lie on the plate's pixels: where lens and sensor act on them before they
// meet the plate.
#pragma once

#include <Eigen/Core>

#include "render/graph.h"
#include "render/surface.h"

namespace matchlight {

/// Points nearer than this are cut off; nothing filmed stands closer to the lens.
inline constexpr double near_plane_m = 0.01;

/// The virtual layer as drawn: a pinhole picture without distortion, finer than the plate.
struct VirtualLayer {
    SurfacePicture picture;                 // colour null where nothing is in view
    SurfacePicture hidden;                  // what the nearest surface hides; colour null unless asked for
    SurfacePicture transparent;             // blended meshes; colour null where they are in `picture`
    double fx = 0, fy = 0, cx = 0, cy = 0;  // of its own pixels, centres at whole numbers
    int whole_density = 0;                  // of its pixels along a plate pixel where that is all of them, else 0
    Eigen::Vector2i first_pixel{0, 0};      // then: the plate pixel in its corner
    const Texture2D* ways = nullptr;        // SurfaceRenderer::draw_ways; null unless motion is gathered
    // For other programs; null unless asked for.
    const Texture2D* way_to_next = nullptr;  // SurfaceRenderer::draw_ways from this frame to its neighbours
    const Texture2D* way_to_previous = nullptr;
    const Texture2D* parts = nullptr;  // SurfaceRenderer::draw_parts
};

/// The same in plate pixels, after what lens and shutter do to it. Where a texture is empty the composite works it out
/// by itself, without any blur.
struct PlateLayer {
    GraphTexture light;     // premultiplied radiance in probe units, a = coverage
    GraphTexture shadow;    // RGB share of the real surface's light that is left
    GraphTexture holdouts;  // RGB share of their light that is left, premultiplied; a = coverage; empty: none in view
    GraphTexture coverage;  // RGB, where the lens parts the channels; empty: the light's own in all of them
};

}  // namespace matchlight
