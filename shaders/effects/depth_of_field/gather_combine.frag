#version 450 core
// The classes over each other, from the nearest to the farthest, and what is sharp between them.
//
// Coverages add up to 1, they do not multiply: two classes that meet within a pixel are mostly the two sides of one
// surface, which leaves no gap; and where a near disc covers a part, what is behind it is there as a whole to fill the
// rest.

#include "common/graph.glsl"

#ifndef CLASSES
#define CLASSES 1
#endif

uniform sampler2D before;           // of the passes before this one, in `light`
uniform ivec4 before_region;
uniform sampler2D before_required;
uniform sampler2D sharp;            // gather_resolve.frag
uniform ivec4 sharp_region;
uniform int sharp_place;            // how many of this pass' classes are before what is sharp; −1: it is elsewhere
uniform int is_last;

// A class: its light and the coverage that it requires, at `scale` plate pixels a texel.
#define CLASS(N) \
    uniform sampler2D class##N; \
    uniform ivec4 class##N##_region; \
    uniform int class##N##_scale; \
    uniform sampler2D required##N;
#if CLASSES > 0
CLASS(0)
#endif
#if CLASSES > 1
CLASS(1)
#endif
#if CLASSES > 2
CLASS(2)
#endif
#if CLASSES > 3
CLASS(3)
#endif

layout(location = 0) out vec4 light;      // premultiplied; a = coverage
layout(location = 1) out float required;

// Rounding of a full coverage is none to correct.
const float rounding = 1e-4;

void add(vec4 next) {
    float left = 1.0 - light.a;
    light += next.a > left + rounding ? next * max(left, 0.0) / next.a : next;
}

#define ADD(N) \
    if (sharp_place == N) add(fetch_or_zero(sharp, sharp_region, target_texel())); \
    { \
        vec2 position = (vec2(target_texel()) + 0.5) / float(class##N##_scale) - 0.5; \
        add(linear_or_zero(class##N, class##N##_region, position)); \
        required = max(required, linear_or_zero(required##N, class##N##_region, position).r); \
    }

void main() {
    light = fetch_or_zero(before, before_region, target_texel());
    required = fetch_or_zero(before_required, before_region, target_texel()).r;
#if CLASSES > 0
    ADD(0)
#endif
#if CLASSES > 1
    ADD(1)
#endif
#if CLASSES > 2
    ADD(2)
#endif
#if CLASSES > 3
    ADD(3)
#endif
    if (sharp_place == CLASSES) add(fetch_or_zero(sharp, sharp_region, target_texel()));
    if (is_last != 0 && light.a > 0.0 && light.a < required) light *= required / light.a;
}
