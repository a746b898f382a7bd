#version 450 core
// Which classes of circles a tile holds: bit (class + class_count) of a whole number.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"
#include "effects/depth_of_field/fragments.glsl"

uniform int tile_px;
uniform int class_count;  // on each side of the focus

layout(location = 0) out float classes;

void main() {
    vec2 corner = vec2(target_texel() * tile_px) - 0.5;
    vec2 low = layer_position(normalized_beyond(corner));
    vec2 high = layer_position(normalized_beyond(corner + float(tile_px)));
    classes = 0.0;
    if (any(isnan(low)) || any(isnan(high))) return;
    // The lens bends the tile's sides, by far less than a pixel.
    ivec2 first = max(ivec2(floor(min(low, high))) - 1, ivec2(0));
    ivec2 last = min(ivec2(ceil(max(low, high))), layer_size - 1);
    uint found = 0u;
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            float depth_share = texelFetch(layer_depth_share, ivec2(x, y), 0).r;
            if (depth_share == 0.0) continue;
            found |= 1u << (class_of(signed_coc_px(depth_share)) + class_count);
            if (hidden_present == 0) continue;
            float hidden_share = texelFetch(hidden_depth_share, ivec2(x, y), 0).r;
            if (hidden_share > 0.0) found |= 1u << (class_of(signed_coc_px(hidden_share)) + class_count);
        }
    }
    classes = float(found);
}
