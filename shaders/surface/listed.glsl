// Counts what a fragment shows among all that its pixel shows, or keeps it (render/sphere_lists.h).
#include "spheres/no_sphere.glsl"

layout(early_fragment_tests) in;

layout(binding = 2, r32ui) uniform uimage2D counts;
layout(binding = 3, r32ui) uniform readonly uimage2D starts;
layout(std430, binding = 3) writeonly buffer Entries { uvec2 entries[]; };            // number, depth (near_m / z)
layout(std430, binding = 5) writeonly buffer ListedLight { uvec2 listed_light[]; };  // half floats
uniform bool counts_only;

// Premultiplied light, and what it covers.
void list(vec4 light) {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint place = imageAtomicAdd(counts, pixel, 1u);
    if (counts_only) return;
    place += imageLoad(starts, pixel).r;
    entries[place] = uvec2(no_sphere | place, floatBitsToUint(gl_FragCoord.z));
    listed_light[place] = uvec2(packHalf2x16(light.rg), packHalf2x16(light.ba));
}
