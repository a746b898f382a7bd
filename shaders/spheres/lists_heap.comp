#version 450 core
// Makes each pixel's spheres a heap.
layout(local_size_x = 8, local_size_y = 8) in;

#include "spheres/heap.glsl"

layout(binding = 2, r32ui) uniform readonly uimage2D counts;
layout(binding = 3, r32ui) uniform readonly uimage2D starts;
uniform int first_row;
uniform ivec2 size_px;

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), size_px))) return;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
    uint count = imageLoad(counts, pixel).r;
    if (count < 2u) return;
    uint start = imageLoad(starts, pixel).r;
    for (int place = int(count / 2u) - 1; place >= 0; --place)
        sift(start, count, uint(place), entries[start + uint(place)]);
}
