#version 450 core
// One slice through one opening. Beyond the frame, of which nothing is known, it is taken to be as within.

#include "common/graph.glsl"

uniform sampler2D slice;
uniform ivec4 slice_region;
uniform ivec4 slice_frame;

struct Tap {
    ivec2 offset;
    float away;
    float area;  // of the texel that the opening shows
};
layout(std430, binding = 0) readonly buffer Taps { Tap taps[]; };
uniform int tap_count;

layout(location = 0) out vec4 blurred;

void main() {
    ivec2 texel = target_texel();
    blurred = vec4(0.0);
    float known = 0.0;
    for (int i = 0; i < tap_count; ++i) {
        ivec2 place = texel + taps[i].offset;
        ivec2 in_frame = place - slice_frame.xy;
        if (any(lessThan(in_frame, ivec2(0))) || any(greaterThanEqual(in_frame, slice_frame.zw))) continue;
        known += taps[i].area;
        blurred += taps[i].area * fetch_or_zero(slice, slice_region, place);
    }
    if (known > 0.0) blurred /= known;
}
