#version 450 core
// Which sphere is nearest in each pixel, and its depth. Links with spheres/sphere.vert.
#include "spheres/meet.glsl"

// The true depth lies behind the front of what sphere.vert draws.
layout(depth_less) out float gl_FragDepth;

layout(location = 0) out uint seen;

#if defined(BEHIND) || defined(PEEL)
uniform sampler2D nearest_depth_share;  // near_m / z of what is in front
#endif
#ifdef PEEL
uniform usampler2D nearest_id;          // of the layer in front
#endif

void main() {
#ifdef PEEL
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint in_front = texelFetch(nearest_id, pixel, 0).r;
#endif
    float depth = meet_depth();
    if (depth < 0.0) discard;
#ifdef BEHIND
    // What is in front, drawn again, may differ by rounding.
    const float same = 1.0 - 1e-5;
    if (depth >= same * texelFetch(nearest_depth_share, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
#ifdef PEEL
    // The same program finds the same depths, to the last bit.
    float peeled = texelFetch(nearest_depth_share, pixel, 0).r;
    if (depth > peeled || (depth == peeled && sphere_id <= in_front)) discard;
#endif
    gl_FragDepth = depth;
    seen = sphere_id;
}
