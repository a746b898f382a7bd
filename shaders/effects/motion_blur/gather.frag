#version 450 core
// Light along each pixel's way: what the pixel's own body shows there over the exposure, under what other bodies smear
// over it. McGuire et al. 2012 and Guertin et al. 2014; deviations in render/effects/motion_blur.h.

#include "common/graph.glsl"
#include "effects/motion_blur/walk.glsl"

uniform sampler2D light;             // premultiplied, a = coverage
uniform ivec4 light_region, light_frame;
uniform sampler2D ways;              // xy: way in pixels; z: body, 0 where there is none; w: 1/m
uniform ivec4 ways_region;
uniform sampler2D dominant;          // of every tile
uniform ivec4 dominant_region;
uniform int tile_px;

layout(location = 0) out vec4 blurred;

// Beyond the frame nothing is known: its outermost pixels go on.
ivec2 in_frame(ivec2 pixel) { return clamp(pixel, light_frame.xy, light_frame.xy + light_frame.zw - 1); }
vec4 light_at(ivec2 pixel) { return fetch_or_zero(light, light_region, in_frame(pixel)); }
vec4 way_at(ivec2 pixel) { return fetch_or_zero(ways, ways_region, in_frame(pixel)); }

// What is seen past the body `own` along its way: itself, and when it has left the pixel what lies behind. What a nearer
// body hides of it is taken to be as here.
vec4 seen_along(ivec2 pixel, vec4 own, vec4 own_light) {
    if (own.xy == vec2(0.0)) return own_light;
    Walk walk = walk_along(own.xy);
    float smear = length(own.xy);
    vec4 sum = vec4(0.0);
    for (int i = -walk.taps; i <= walk.taps; ++i) {
        float weight = smear_at(float(i) * walk.spacing, walk.spacing, smear);
        if (weight == 0.0) continue;
        Tap tap = tap_at(pixel, walk, i);
        for (int side = 0; side < 2; ++side) {
            float share = side == 0 ? 1.0 - tap.second_share : tap.second_share;
            if (share == 0.0) continue;
            ivec2 at = side == 0 ? tap.first : tap.second;
            vec4 there = way_at(at);
            bool hidden = there.z != 0.0 && there.z != own.z && there.w > own.w;
            sum += weight * share * (hidden ? own_light : light_at(at));
        }
    }
    return sum;
}

// What other bodies, nearer than the pixel's own, smear over it. Light that belongs to no body (out of focus) moves as
// the dominant does.
vec4 smeared_over(ivec2 pixel, vec4 own, vec2 way) {
    if (way == vec2(0.0)) return own.z == 0.0 ? light_at(pixel) : vec4(0.0);
    Walk walk = walk_along(way);
    vec2 direction = normalize(way);
    vec4 sum = vec4(0.0);
    for (int i = -walk.taps; i <= walk.taps; ++i) {
        float distance_px = float(i) * walk.spacing;
        Tap tap = tap_at(pixel, walk, i);
        for (int side = 0; side < 2; ++side) {
            float share = side == 0 ? 1.0 - tap.second_share : tap.second_share;
            if (share == 0.0) continue;
            ivec2 at = side == 0 ? tap.first : tap.second;
            vec4 there = way_at(at);
            if (own.z != 0.0 && (there.z == 0.0 || there.z == own.z || there.w <= own.w)) continue;
            vec2 its_way = there.z == 0.0 ? way : there.xy;
            float weight = smear_at(distance_px, walk.spacing, abs(dot(its_way, direction)));
            if (weight > 0.0) sum += weight * share * light_at(at);
        }
    }
    return sum.a > 1.0 ? sum / sum.a : sum;
}

void main() {
    ivec2 pixel = target_texel();
    vec4 own_light = fetch_or_zero(light, light_region, pixel);
    vec2 way = fetch_or_zero(dominant, dominant_region, pixel / tile_px).xy;
    blurred = own_light;
    if (way == vec2(0.0)) return;
    vec4 own = way_at(pixel);
    vec4 over = smeared_over(pixel, own, way);
    blurred = own.z == 0.0 ? over : over + (1.0 - over.a) * seen_along(pixel, own, own_light);
}
