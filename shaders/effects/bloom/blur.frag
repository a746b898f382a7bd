#version 450 core
// A symmetric filter along one axis (STEP), of 2 RADIUS + 1 taps; added to the sum of the wider Gaussians, which is as
// fine (WIDER 1) or half as fine (WIDER 2).
#include "common/graph.glsl"

#ifndef RADIUS
#define RADIUS 1
#define STEP ivec2(1, 0)
#endif

uniform sampler2D source;
uniform ivec4 source_region;
uniform float taps[RADIUS + 1];
#ifdef WIDER
uniform sampler2D wider;
uniform ivec4 wider_region;
#endif

out vec4 light;

void main() {
    ivec2 texel = target_texel();
    light = taps[0] * fetch_or_zero(source, source_region, texel);
    for (int i = 1; i <= RADIUS; ++i) {
        light += taps[i] * (fetch_or_zero(source, source_region, texel - i * STEP) +
                            fetch_or_zero(source, source_region, texel + i * STEP));
    }
#if defined(WIDER) && WIDER == 1
    light += fetch_or_zero(wider, wider_region, texel);
#elif defined(WIDER)
    light += linear_or_zero(wider, wider_region, 0.5 * vec2(texel) - 0.25);
#endif
}
