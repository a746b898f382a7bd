#version 450 core
// Signed circles of confusion of a layer, in pixels: x = circle, negative before the focus; y = 1 where something is.

#include "common/graph.glsl"

uniform sampler2D inverse_depth;
uniform ivec4 inverse_depth_region;
uniform float coc_scale_px_m;
uniform float inverse_focus;  // 1/m

layout(location = 0) out vec2 circle;

void main() {
    float inverse = fetch_or_zero(inverse_depth, inverse_depth_region, target_texel()).r;
    circle = inverse > 0.0 ? vec2(coc_scale_px_m * (inverse_focus - inverse), 1.0) : vec2(0.0);
}
