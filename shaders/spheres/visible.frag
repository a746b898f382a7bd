#version 450 core
// Which sphere is nearest in each pixel, and its depth. Links with spheres/sphere.vert.
#include "spheres/meet.glsl"

// The true depth lies behind the front of what sphere.vert draws.
layout(depth_less) out float gl_FragDepth;

layout(location = 0) out uint seen;

#ifdef BEHIND
uniform sampler2D nearest_depth_share;  // near_m / z of what is in front
#endif

void main() {
    float depth = meet_depth();
    if (depth < 0.0) discard;
#ifdef BEHIND
    // What is in front, drawn again, may differ by rounding.
    const float same = 1.0 - 1e-5;
    if (depth >= same * texelFetch(nearest_depth_share, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
    gl_FragDepth = depth;
    seen = sphere_id;
}
