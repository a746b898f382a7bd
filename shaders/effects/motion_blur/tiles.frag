#version 450 core
// The longest way within each tile.

#include "common/graph.glsl"

uniform sampler2D ways;
uniform ivec4 ways_region;
uniform int tile_px;

layout(location = 0) out vec2 longest;

void main() {
    ivec2 corner = target_texel() * tile_px;
    longest = vec2(0.0);
    for (int y = 0; y < tile_px; ++y) {
        for (int x = 0; x < tile_px; ++x) {
            vec2 way = fetch_or_zero(ways, ways_region, corner + ivec2(x, y)).xy;
            if (dot(way, way) > dot(longest, longest)) longest = way;
        }
    }
}
