#version 450 core
// A kernel over the virtual layer along one axis (STEP), of 2 RADIUS + 1 taps.

#include "common/graph.glsl"

#ifndef RADIUS
#define RADIUS 1
#define STEP ivec2(1, 0)
#endif

uniform sampler2D layer;        // premultiplied light, coverage
uniform ivec4 layer_region, layer_frame;
uniform float taps[RADIUS + 1];
#ifdef COVERAGE
uniform sampler2D coverage;     // of each channel
uniform ivec4 coverage_region;
#endif

layout(location = 0) out vec4 light;
#ifdef COVERAGE
layout(location = 1) out vec4 blurred_coverage;
#endif

// Beyond the frame's edge the layer goes on as it ends there.
ivec2 in_frame(ivec2 texel) { return clamp(texel, layer_frame.xy, layer_frame.xy + layer_frame.zw - 1); }

void main() {
    ivec2 texel = target_texel();
    light = vec4(0.0);
#ifdef COVERAGE
    blurred_coverage = vec4(0.0);
#endif
    for (int i = -RADIUS; i <= RADIUS; ++i) {
        ivec2 from = in_frame(texel + i * STEP);
        light += taps[abs(i)] * fetch_or_zero(layer, layer_region, from);
#ifdef COVERAGE
        blurred_coverage += taps[abs(i)] * fetch_or_zero(coverage, coverage_region, from);
#endif
    }
}
