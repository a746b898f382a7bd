#version 450 core
// A slice before those that are farther away.

#include "common/graph.glsl"

uniform sampler2D slice;
uniform ivec4 slice_region;
uniform ivec4 slice_frame;
uniform int slice_scale;
uniform sampler2D behind;
uniform ivec4 behind_region;
uniform int disjoint;

layout(location = 0) out vec4 both;

void main() {
    ivec2 pixel = target_texel();
    vec4 front = slice_scale == 1 ? fetch_or_zero(slice, slice_region, pixel)
                                  : linear_in_frame(slice, slice_region, slice_frame,
                                                    (vec2(pixel) + 0.5) / float(slice_scale) - 0.5);
    vec4 back = fetch_or_zero(behind, behind_region, pixel);
    float left = 1.0 - front.a;
    // Porter & Duff's over takes coverages for independent; slices share no pixel, so that theirs add up until they fill
    // it.
    float share = disjoint != 0 && back.a > 0.0 ? clamp(left / back.a, 0.0, 1.0) : left;
    both = front + share * back;
}
