#version 450 core
// The sum of up to three squares that each cover the frame, interpolated between their texels.
#include "common/graph.glsl"

uniform sampler2D square0, square1, square2;
uniform ivec4 square0_region, square1_region, square2_region;
uniform float size0, size1, size2;
uniform vec2 texel_share;  // of the frame that a texel written is
uniform float weight;

out vec4 light;

vec4 magnified(sampler2D square, ivec4 region, float size, vec2 place) {
    // The frame's edge is the squares' own: beyond it the last texel holds.
    return linear_or_zero(square, region, clamp(place * size - 0.5, vec2(0.0), vec2(size - 1.0)));
}

void main() {
    vec2 place = (vec2(target_texel()) + 0.5) * texel_share;
    vec4 sum = magnified(square0, square0_region, size0, place);
#if SQUARES > 1
    sum += magnified(square1, square1_region, size1, place);
#endif
#if SQUARES > 2
    sum += magnified(square2, square2_region, size2, place);
#endif
    light = weight * sum;
}
