#version 450 core
// Which classes of circles a tile holds.

#include "common/graph.glsl"
#include "effects/depth_of_field/circles.glsl"

uniform sampler2D circles;      // gather_resolve.frag
uniform ivec4 circles_region;
uniform int tile_px;

layout(location = 0) out uint classes;

void main() {
    ivec2 corner = target_texel() * tile_px - circles_region.xy;
    ivec2 first = max(corner, ivec2(0));
    ivec2 last = min(corner + tile_px, circles_region.zw) - 1;
    uint found = 0u;
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec4 seen = texelFetch(circles, ivec2(x, y), 0);
            if (seen.a > 0.0) found |= bit_of(0);
            if (seen.r != 0.0) found |= bit_of(class_of(seen.r));
            if (seen.g != 0.0) found |= bit_of(class_of(seen.g));
        }
    }
    classes = found;
}
