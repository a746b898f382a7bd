#version 450 core
// Spheres seen along parallel light: only depth is kept. Links with spheres/sphere.vert.
#include "spheres/meet.glsl"

layout(depth_less) out float gl_FragDepth;

void main() {
    float depth = meet_depth();
    if (depth < 0.0) discard;
    gl_FragDepth = depth;
}
