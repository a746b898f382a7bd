#version 450 core
// From texels to pixels.

#include "common/graph.glsl"

uniform sampler2D blurred;
uniform ivec4 blurred_region;
uniform int texel_px;

layout(location = 0) out vec4 light;

void main() {
    vec2 position = (vec2(target_texel()) + 0.5) / float(texel_px) - 0.5;
    light = linear_or_zero(blurred, blurred_region, position);
}
