#version 450 core
// The classes over each other, from the nearest to the farthest, and what is sharp between them.
//
// Coverages add up to 1, they do not multiply: two classes that meet within a pixel are mostly the two sides of one
// surface, which leaves no gap; and where a near disc covers a part, what is behind it is there as a whole to fill the
// rest.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"
#include "effects/depth_of_field/fragments.glsl"

uniform sampler2D before;           // of the passes before this one, in `light`
uniform ivec4 before_region;
uniform sampler2D before_required;
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

// The layer's light over a pixel, as layer_over_pixel() has it, of points that stay sharp alone.
vec4 sharp_over_pixel(vec2 pixel) {
    vec2 normalized = normalized_from_pixel(pixel);
    if (any(isnan(normalized)) || layer_present == 0) return vec4(0.0);
    vec2 footprint = layer_footprint(pixel, normalized);
    vec2 centre = layer_position(normalized);
    vec2 low = centre - 0.5 * footprint;
    vec2 high = centre + 0.5 * footprint;
    ivec2 first = max(ivec2(floor(low)), ivec2(0));
    ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;
    vec4 sum = vec4(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        float height = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float width = min(high.x, float(x + 1)) - max(low.x, float(x));
            float depth_share = texelFetch(layer_depth_share, ivec2(x, y), 0).r;
            // Without a depth it is a surface that lets light through over nothing else.
            if (depth_share == 0.0 || class_of(signed_coc_px(depth_share)) == 0) {
                sum += width * height * texelFetch(layer, ivec2(x, y), 0);
            } else if (hidden_present != 0) {
                depth_share = texelFetch(hidden_depth_share, ivec2(x, y), 0).r;
                if (depth_share > 0.0 && class_of(signed_coc_px(depth_share)) == 0)
                    sum += width * height * texelFetch(hidden_layer, ivec2(x, y), 0);
            }
        }
    }
    return sum / (footprint.x * footprint.y);
}

#define ADD(N) \
    if (sharp_place == N) add(sharp_over_pixel(pixel)); \
    { \
        vec2 position = (pixel + 0.5) / float(class##N##_scale) - 0.5; \
        add(linear_or_zero(class##N, class##N##_region, position)); \
        required = max(required, linear_or_zero(required##N, class##N##_region, position).r); \
    }

void main() {
    vec2 pixel = vec2(target_texel());
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
    if (sharp_place == CLASSES) add(sharp_over_pixel(pixel));
    if (is_last != 0 && light.a > 0.0 && light.a < required) light *= required / light.a;
}
