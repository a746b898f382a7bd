#version 450 core
// The way of the nearest surface in each plate pixel.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"
#include "effects/motion_blur/way.glsl"

uniform sampler2D layer_ways;  // xy: change of x/z and y/z; z: object id; w: 1/z
uniform int ways_present;

layout(location = 0) out vec4 plate_way;  // xy in plate pixels

void main() {
    vec2 pixel = vec2(target_texel());
    vec2 normalized = normalized_from_pixel(pixel);
    plate_way = vec4(0.0);
    if (any(isnan(normalized)) || ways_present == 0) return;
    vec2 footprint = layer_footprint(pixel, normalized);
    vec2 centre = layer_position(normalized);
    ivec2 first = max(ivec2(floor(centre - 0.5 * footprint)), ivec2(0));
    ivec2 last = min(ivec2(ceil(centre + 0.5 * footprint)), layer_size) - 1;
    vec4 nearest = vec4(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec4 way = texelFetch(layer_ways, ivec2(x, y), 0);
            if (way.w > nearest.w) nearest = way;
        }
    }
    plate_way = vec4(way_of_change(nearest.xy, pixel, normalized), nearest.zw);
}
