#version 450 core
// Gives each pixel the place of its spheres among those of all, and counts from 0 again.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 2, r32ui) uniform uimage2D counts;
layout(binding = 3, r32ui) uniform uimage2D starts;
layout(std430, binding = 2) buffer Total { uint total, wrapped; };
uniform int first_row;
uniform ivec2 size_px;

void main() {
    if (any(greaterThanEqual(ivec2(gl_GlobalInvocationID.xy), size_px))) return;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
    uint count = imageLoad(counts, pixel).r;
    if (count == 0u) return;
    uint start = atomicAdd(total, count);
    if (start + count < start) wrapped = 1u;
    imageStore(starts, pixel, uvec4(start));
    imageStore(counts, pixel, uvec4(0u));
}
