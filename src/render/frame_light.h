// What the camera's effects act on: the light that virtual objects add to a frame or take away from it.
#pragma once

#include "render/graph.h"

namespace matchlight {

/// Plate-linear light (1 is the brightest code) over the part of the frame that virtual things touch; outside of it
/// nothing was added or taken away. Effects spread bright(after) − bright(before): what the footage's own bright light
/// spills is in the footage already, and a lamp that an object hides takes its spill along.
struct FrameLight {
    GraphTexture after;   // RGBA: light with the objects; a is the share of it that objects send (their coverage)
    GraphTexture before;  // RGB: the plate's own light; empty in scenes without footage, where all light is virtual
};

}  // namespace matchlight
