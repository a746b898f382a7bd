#version 450 core
// One of the two passes, along STEP, after Zhou, Chen & Pullen 2007 (weights.glsl).
//
// The first hands its circles on to the second, as light has none of its own where it falls beside what it came from.

#include "common/graph.glsl"
#include "effects/depth_of_field/weights.glsl"

#ifndef STEP
#define STEP ivec2(1, 0)
#endif

uniform int reach;  // of the widest circle

layout(location = 0) out vec4 blurred;
layout(location = 1) out vec2 circle;

int along(ivec2 v) { return STEP.x * v.x + STEP.y * v.y; }

void main() {
    ivec2 texel = target_texel();
    vec2 own = fetch_or_zero(circles, circles_region, texel).xy;
    // Beyond the frame nothing is known.
    int first = max(-reach, along(circles_frame.xy - texel));
    int last = min(reach, along(circles_frame.xy + circles_frame.zw - texel) - 1);
    Gathered sum = Gathered(vec4(0.0), 0.0, 0.0, 0.0, 0.0);
    for (int i = first; i <= last; ++i) take(sum, own, texel + i * STEP, float(abs(i)), 1.0);
    blurred = vec4(0.0);
    circle = own.y > 0.0 ? own : handed_on(sum);
    if (sum.weight == 0.0) return;
    float whole = sum.weight + sum.plate;
    if (own.y == 0.0) {
        // As much as all places within the circle would give: what of it is not virtual is the plate.
        whole = 0.0;
        float radius = radius_of(circle.x);
        for (int i = first; i <= last; ++i) whole += overlap(radius, float(abs(i))) * intensity(radius);
        whole = max(whole, sum.weight);
    }
    blurred = sum.light / whole;
}
