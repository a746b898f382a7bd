#version 450 core
// Spheres seen along parallel light from both sides at once: the height towards either. Links with spheres/sphere.vert.

#ifndef PARALLEL
#define PARALLEL
#endif
#include "spheres/meet.glsl"

layout(location = 0) out vec2 heights;

void main() {
    vec2 depths = meet_depths();
    if (depths.x < 0.0) discard;
    heights = vec2(depths.x, 1.0 - depths.y);
}
