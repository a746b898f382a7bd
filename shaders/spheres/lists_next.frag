#version 450 core
// Takes the nearest sphere away from each pixel's.
#include "spheres/heap.glsl"

layout(binding = 2, r32ui) uniform uimage2D counts;
layout(binding = 3, r32ui) uniform readonly uimage2D starts;
uniform bool is_first;
uniform sampler2D covered;  // by the layers in front: alpha
uniform float enough;

layout(location = 0) out uint seen;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint count = imageLoad(counts, pixel).r;
    if (count == 0u || (!is_first && texelFetch(covered, pixel, 0).a >= enough)) discard;
    uint start = imageLoad(starts, pixel).r;
    uvec2 nearest = entries[start];
    --count;
    if (count > 0u) sift(start, count, 0u, entries[start + count]);
    imageStore(counts, pixel, uvec4(count));
    seen = nearest.x;
    gl_FragDepth = uintBitsToFloat(nearest.y);
}
