#version 450 core
// One of Kawase's passes, for the streaks that run forward and backward along a line; the last adds them up.
#include "common/graph.glsl"
#include "effects/streaks/line.glsl"

#ifndef TAPS
#define TAPS 4
#endif

uniform float weights[TAPS];
uniform int stride;
#ifdef FORWARD
uniform sampler2D forward;
uniform ivec4 forward_region;
#endif
#ifdef BACKWARD
uniform sampler2D backward;
uniform ivec4 backward_region;
#endif

#ifdef LAST
uniform sampler2D source;
uniform ivec4 source_region;
uniform float streak_share;
uniform float source_share;
out vec4 light;
#else
layout(location = 0) out vec4 first;
#if defined(FORWARD) && defined(BACKWARD)
layout(location = 1) out vec4 second;
#endif
#endif

void main() {
    ivec2 texel = target_texel();
    vec4 ahead = vec4(0.0), behind = vec4(0.0);
    for (int s = 0; s < TAPS; ++s) {
#ifdef FORWARD
        ahead += weights[s] * fetch_or_zero(forward, forward_region, along(texel, -stride * s));
#endif
#ifdef BACKWARD
        behind += weights[s] * fetch_or_zero(backward, backward_region, along(texel, stride * s));
#endif
    }
#ifdef LAST
    light = streak_share * (ahead + behind) + source_share * fetch_or_zero(source, source_region, texel);
#elif defined(FORWARD)
    first = ahead;
#ifdef BACKWARD
    second = behind;
#endif
#else
    first = behind;
#endif
}
