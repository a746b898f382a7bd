#version 450 core
// Looks each pixel's circle up in the pyramid, between the two levels whose variances are next to the disc's.

#include "common/graph.glsl"

#ifndef LEVELS
#define LEVELS 1
#endif

uniform sampler2D light;         // premultiplied, coverage
uniform ivec4 light_region;
uniform sampler2D circles;       // x = signed circle in pixels, y = 1 where something is
uniform ivec4 circles_region;
uniform sampler2D weighted[LEVELS];  // of mip_reduce.frag, the finest first
uniform sampler2D shares[LEVELS];
uniform ivec4 level_region[LEVELS];
uniform float least_coc_px;
uniform float least_full_px;     // circles from this on count fully on the finest level

layout(location = 0) out vec4 blurred;

// Of what is looked up on level 1, 2, …: (2 · 4^level − 1) / 4, half of it from the steps down and half from here, where
// texels are magnified by quadratic B-splines; 0 is the picture itself. In pixels² along an axis.
float variance_of(int level) { return level == 0 ? 0.0 : 0.25 * (2.0 * exp2(2.0 * float(level)) - 1.0); }

// Of the disc that has it: c²/16.
float circle_of(int level) { return 4.0 * sqrt(variance_of(level)); }

void look_up(int index, ivec2 pixel, out vec4 light_sum, out vec4 share_sum) {
    vec2 place = (vec2(pixel) + 0.5) * exp2(-float(index + 1)) - 0.5;
    vec2 middle = floor(place + 0.5);
    vec2 f = place - middle;
    vec2 taps[3] = vec2[](0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f));
    light_sum = vec4(0.0);
    share_sum = vec4(0.0);
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 3; ++x) {
            ivec2 texel = ivec2(middle) + ivec2(x, y) - 1;
            float tap = taps[x].x * taps[y].y;
            light_sum += tap * fetch_or_zero(weighted[index], level_region[index], texel);
            share_sum += tap * fetch_or_zero(shares[index], level_region[index], texel);
        }
    }
}

void main() {
    ivec2 pixel = target_texel();
    vec2 own = fetch_or_zero(circles, circles_region, pixel).xy;
    vec4 sharp = fetch_or_zero(light, light_region, pixel);
    blurred = sharp;
    vec4 light_sum, share_sum;
    float circle = abs(own.x);
    if (own.y == 0.0) {
        // The degree of blur spreads over the plate with the light: the widest circle that reaches so far.
        circle = 0.0;
        for (int index = LEVELS - 1; index >= 0; --index) {
            if (circle > 0.0) continue;
            look_up(index, pixel, light_sum, share_sum);
            float mean = share_sum.y > 0.0 ? share_sum.x / share_sum.y : 0.0;
            if (mean >= (index == 0 ? least_coc_px : circle_of(index))) circle = mean;
        }
    }
    if (circle < least_coc_px) return;

    float variance = circle * circle / 16.0;
    int finer = 0;
    while (finer < LEVELS && variance_of(finer + 1) <= variance) ++finer;
    float t = finer == LEVELS ? 0.0 : (variance - variance_of(finer)) / (variance_of(finer + 1) - variance_of(finer));
    float counts = min(circle / least_full_px, 1.0);  // of what has this very circle
    vec4 sum = finer == 0 ? (1.0 - t) * sharp : vec4(0.0);
    for (int index = 0; index < LEVELS; ++index) {
        float part = index + 1 == finer ? 1.0 - t : (index == finer ? t : 0.0);
        if (part == 0.0) continue;
        look_up(index, pixel, light_sum, share_sum);
        // A covered pixel shows the plate where nothing is; beside what is covered, the plate is all that is not.
        float whole = own.y > 0.0 ? share_sum.y + counts * share_sum.z : max(counts * share_sum.w, share_sum.y);
        sum += part * (whole > 0.0 ? light_sum / whole : sharp);
    }
    blurred = sum;
}
