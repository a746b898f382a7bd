#version 450 core
// The mean over the same disc everywhere.

#include "common/graph.glsl"

#ifndef TAPS
#define TAPS 1
#endif

uniform sampler2D light;  // has room for all taps
uniform ivec4 light_region;
uniform vec4 taps[TAPS];  // offset in texels, share of the light

layout(location = 0) out vec4 blurred;

void main() {
    ivec2 place = target_texel() - light_region.xy;
    blurred = vec4(0.0);
    for (int i = 0; i < TAPS; ++i) blurred += taps[i].z * texelFetch(light, place + ivec2(taps[i].xy), 0);
}
