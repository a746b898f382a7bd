#version 450 core
// Every sphere that a pixel meets: counts them (COUNT), or keeps them (KEEP). Links with spheres/sphere.vert.
#include "spheres/meet.glsl"

// What lies wholly behind what is opaque is left out; of what reaches out of it the rest is left to who asks.
layout(early_fragment_tests) in;

layout(binding = 2, r32ui) uniform uimage2D counts;
uniform ivec2 end_px;  // of what is asked for: some drivers draw a point one row beyond the scissor, too
#ifdef KEEP
layout(binding = 3, r32ui) uniform readonly uimage2D starts;
layout(std430, binding = 3) writeonly buffer Entries { uvec2 entries[]; };
#endif

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = meet_depth();
    if (depth < 0.0 || any(greaterThanEqual(pixel, end_px))) discard;
    uint place = imageAtomicAdd(counts, pixel, 1u);
#ifdef KEEP
    entries[imageLoad(starts, pixel).r + place] = uvec2(sphere_id, floatBitsToUint(depth));
#endif
}
