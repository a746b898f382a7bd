// A pixel's spheres as a heap, the nearest on top; of those at one depth the first of the set.
#include "spheres/no_sphere.glsl"

layout(std430, binding = 3) buffer Entries { uvec2 entries[]; };  // number, depth (near_m / z: larger is nearer)

// What is no sphere (surface/listed.glsl) is numbered as threads came, anew in each run: of two of those at one depth
// their light says which is before, not the thread.
layout(std430, binding = 5) readonly buffer ListedLight { uvec2 listed_light[]; };

bool is_before(uvec2 a, uvec2 b) {
    // Depths are positive: their bits are in their order.
    if (a.y != b.y) return a.y > b.y;
    if (a.x < no_sphere || b.x < no_sphere) return a.x < b.x;
    uvec2 light_a = listed_light[a.x - no_sphere], light_b = listed_light[b.x - no_sphere];
    return light_a.x < light_b.x || (light_a.x == light_b.x && light_a.y < light_b.y);
}

// Puts `entry` at `place` of a heap of `count`, or below it.
void sift(uint start, uint count, uint place, uvec2 entry) {
    while (2u * place + 1u < count) {
        uint below = 2u * place + 1u;
        uvec2 nearer = entries[start + below];
        if (below + 1u < count) {
            uvec2 other = entries[start + below + 1u];
            if (is_before(other, nearer)) {
                nearer = other;
                ++below;
            }
        }
        if (!is_before(nearer, entry)) break;
        entries[start + place] = nearer;
        place = below;
    }
    entries[start + place] = entry;
}
