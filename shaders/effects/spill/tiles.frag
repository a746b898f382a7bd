#version 450 core
// The most that any channel of the spilled light changes within each tile of the frame.
#include "common/graph.glsl"

uniform sampler2D spill;
uniform ivec4 spill_region;
uniform int spill_scale;
uniform int target_scale;  // frame pixels along a side of a tile

layout(location = 0) out float most;

void main() {
    // The response pass samples linearly: half a texel beyond the tile counts too.
    ivec2 first = max(target_texel() * target_scale / spill_scale - 1, spill_region.xy);
    ivec2 last = min(((target_texel() + 1) * target_scale - 1) / spill_scale + 1, spill_region.xy + spill_region.zw - 1);
    vec3 largest = vec3(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            largest = max(largest, abs(texelFetch(spill, ivec2(x, y) - spill_region.xy, 0).rgb));
        }
    }
    most = max(largest.r, max(largest.g, largest.b));
}
