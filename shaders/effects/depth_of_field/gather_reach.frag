#version 450 core
// Which classes of circles reach a tile from anywhere.

#include "common/graph.glsl"
#include "effects/depth_of_field/circles.glsl"

uniform sampler2D classes;      // gather_mask.frag
uniform ivec4 classes_region;
uniform int tile_px;
uniform int farthest_tiles;     // of the widest class
uniform float first_reach_px;   // of the narrowest class; each reaches twice as far as the one before

layout(location = 0) out float reached;

void main() {
    ivec2 tile = target_texel();
    ivec2 place = tile - classes_region.xy;
    ivec2 first = max(place - farthest_tiles, ivec2(0));
    ivec2 last = min(place + farthest_tiles, classes_region.zw - 1);
    uint found = 0u;
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            uint there = uint(texelFetch(classes, ivec2(x, y), 0).r);
            ivec2 steps = abs(ivec2(x, y) - place);
            // From edge to edge. The classes that reach so far are the outermost bits on both sides.
            float apart_px = float(max(max(steps.x, steps.y) - 1, 0) * tile_px);
            int narrowest = 1 + max(int(ceil(log2(apart_px / first_reach_px))), 0);
            uint wide = (1u << max(class_count - narrowest + 1, 0)) - 1u;
            found |= there & (apart_px > 0.0 ? wide | (wide << (class_count + narrowest)) : ~0u);
        }
    }
    reached = float(found);
}
