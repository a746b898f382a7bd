#version 450 core
// A gather over the disc in one pass, from samples on rings, with the weights of weights.glsl.

#include "common/graph.glsl"
#include "effects/depth_of_field/weights.glsl"

struct Tap {
    ivec2 offset;
    float away;
    float area;  // pixels that it stands for
};
layout(std430, binding = 0) readonly buffer Taps { Tap taps[]; };
uniform int tap_count;

layout(location = 0) out vec4 blurred;

bool in_frame(ivec2 texel) {
    ivec2 place = texel - circles_frame.xy;
    return all(greaterThanEqual(place, ivec2(0))) && all(lessThan(place, circles_frame.zw));
}

void main() {
    ivec2 texel = target_texel();
    vec2 own = fetch_or_zero(circles, circles_region, texel).xy;
    Gathered sum = Gathered(vec4(0.0), 0.0, 0.0, 0.0, 0.0);
    for (int i = 0; i < tap_count; ++i) {
        ivec2 place = texel + taps[i].offset;
        if (in_frame(place)) take(sum, own, place, taps[i].away, taps[i].area);
    }
    blurred = vec4(0.0);
    if (sum.weight == 0.0) return;
    float whole = sum.weight + sum.plate;
    if (own.y == 0.0) {
        whole = 0.0;
        float radius = radius_of(handed_on(sum).x);
        for (int i = 0; i < tap_count; ++i) {
            if (!in_frame(texel + taps[i].offset)) continue;
            whole += taps[i].area * overlap(radius, taps[i].away) * intensity(radius);
        }
        whole = max(whole, sum.weight);
    }
    blurred = sum.light / whole;
}
