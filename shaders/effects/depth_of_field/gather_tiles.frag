#version 450 core
// The widest disc in each tile of a class, and around it.

#include "common/graph.glsl"

uniform sampler2D discs;        // gather_sort.frag, or what this makes of it
uniform ivec4 discs_region;
uniform int tile_texels;        // of `discs`
uniform int margin_texels;

layout(location = 0) out float widest;

void main() {
    ivec2 corner = target_texel() * tile_texels - discs_region.xy;
    ivec2 first = max(corner - margin_texels, ivec2(0));
    ivec2 last = min(corner + tile_texels + margin_texels, discs_region.zw) - 1;
    widest = 0.0;
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) widest = max(widest, texelFetch(discs, ivec2(x, y), 0).r);
}
