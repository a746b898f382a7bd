#version 450 core
// The virtual layer on plate pixels, for what lens and shutter do to it.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"

uniform sampler2D layer_depth_share;  // near_m / z, 0 where nothing is
uniform float near_m;

layout(location = 0) out vec4 light;           // premultiplied, probe units
layout(location = 1) out float inverse_depth;  // 1/m of the nearest surface in the pixel

void main() {
    vec2 pixel = vec2(target_texel());
    vec2 normalized = normalized_from_pixel(pixel);
    light = vec4(0.0);
    inverse_depth = 0.0;
    if (any(isnan(normalized)) || layer_present == 0) return;
    light = layer_over_pixel(target_texel(), normalized);
#if LAYER_DENSITY > 0
    ivec2 first = (target_texel() - layer_first_pixel) * LAYER_DENSITY;
    if (any(lessThan(first, ivec2(0))) || any(greaterThanEqual(first, layer_size))) return;
    ivec2 last = first + LAYER_DENSITY - 1;
#else
    vec2 footprint = layer_footprint(pixel, normalized);
    vec2 centre = layer_position(normalized);
    ivec2 first = max(ivec2(floor(centre - 0.5 * footprint)), ivec2(0));
    ivec2 last = min(ivec2(ceil(centre + 0.5 * footprint)), layer_size) - 1;
#endif
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x)
            inverse_depth = max(inverse_depth, texelFetch(layer_depth_share, ivec2(x, y), 0).r / near_m);
}
