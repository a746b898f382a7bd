#version 450 core
// Which tiles of a slice hold anything: most are empty, and need no blur.

#include "common/graph.glsl"

uniform sampler2D slice;
uniform ivec4 slice_region;
uniform int tile;  // texels along a side

layout(location = 0) out float holds;

void main() {
    ivec2 first = target_texel() * tile;
    holds = 0.0;
    for (int y = 0; y < tile; ++y) {
        for (int x = 0; x < tile; ++x) {
            if (any(greaterThan(fetch_or_zero(slice, slice_region, first + ivec2(x, y)), vec4(0.0)))) holds = 1.0;
        }
    }
}
