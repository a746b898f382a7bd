// A pixel's spheres as a heap, the nearest on top; of those at one depth the first of the set.
layout(std430, binding = 3) buffer Entries { uvec2 entries[]; };  // number, depth (near_m / z: larger is nearer)

bool is_before(uvec2 a, uvec2 b) {
    // Depths are positive: their bits are in their order.
    return a.y > b.y || (a.y == b.y && a.x < b.x);
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
