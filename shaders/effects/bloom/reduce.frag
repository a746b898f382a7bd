#version 450 core
// Half the resolution by [1 3 3 1]/8 along both axes: what comes in goes out.
#include "common/graph.glsl"

uniform sampler2D source;
uniform ivec4 source_region;

out vec4 light;

void main() {
    ivec2 first = target_texel() * 2 - 1;
    const float weights[4] = float[4](0.125, 0.375, 0.375, 0.125);
    light = vec4(0.0);
    for (int y = 0; y < 4; ++y) {
        vec4 row = vec4(0.0);
        for (int x = 0; x < 4; ++x) row += weights[x] * fetch_or_zero(source, source_region, first + ivec2(x, y));
        light += weights[y] * row;
    }
}
