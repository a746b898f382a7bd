#version 450 core
// The longest way whose smear reaches a tile.

#include "common/graph.glsl"

uniform sampler2D tiles;
uniform ivec4 tiles_region;
uniform int reach;      // tiles on either side
uniform int tile_px;
uniform float soft_px;  // how far light lies outside of what moves

layout(location = 0) out vec2 dominant;

void main() {
    ivec2 tile = target_texel();
    dominant = vec2(0.0);
    // Between two tiles' farthest points more than between their middles.
    float slack_px = sqrt(2.0) * float(tile_px) + soft_px;
    ivec2 first = max(ivec2(-reach), tiles_region.xy - tile);
    ivec2 last = min(ivec2(reach), tiles_region.xy + tiles_region.zw - 1 - tile);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec2 way = fetch_or_zero(tiles, tiles_region, tile + ivec2(x, y)).xy;
            float squared = dot(way, way);
            if (squared <= dot(dominant, dominant)) continue;
            vec2 direction = way * inversesqrt(squared);
            vec2 away = vec2(x, y) * float(tile_px);
            float along = abs(dot(away, direction));
            float across = abs(away.x * direction.y - away.y * direction.x);
            if (along <= 0.5 * sqrt(squared) + slack_px && across <= slack_px) dominant = way;
        }
    }
}
