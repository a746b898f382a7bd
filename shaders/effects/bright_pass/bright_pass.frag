#version 450 core
// Light above the threshold with the objects, less that without them: its mean over SCALE × SCALE frame pixels. Texels
// without such light are not written: the target was cleared.
#include "common/condition.glsl"
#include "common/graph.glsl"

#ifndef SCALE
#define SCALE 1
#endif

uniform sampler2D after;  // RGB light, a: share of it that objects send
uniform ivec4 after_region;
uniform sampler2D before;
uniform ivec4 before_region;
uniform float threshold;
uniform float knee_half_width;  // of the threshold
uniform vec2 share;             // of `after` that counts: x + a·y
uniform float measure_luminance;

out vec4 difference;

const float largest_half = 65504.0;

// bright_share() of render/effects/bright_light.h, of what can be light: not NaN, not negative, at most what a half
// float holds. Luminance: Rec. 709 in the digits of the classic model.
vec3 bright(vec3 light) {
    light = mix(vec3(0.0), min(light, largest_half), greaterThan(light, vec3(0.0)));
    float m = mix(max(light.r, max(light.g, light.b)), dot(light, vec3(0.2125, 0.7154, 0.0721)), measure_luminance);
    float in_knee = clamp(m - threshold + knee_half_width, 0.0, 2.0 * knee_half_width);
    float over = max(m - threshold, in_knee * in_knee / max(4.0 * knee_half_width, 1e-30));
    return light * (over / max(m, 1e-30));
}

vec3 difference_at(ivec2 place) {  // counts from after's first texel
    vec4 with_objects = texelFetch(after, place, 0);
    float a = with_objects.a > 0.0 ? min(with_objects.a, 1.0) : 0.0;
    vec3 light = bright(with_objects.rgb) * (share.x + a * share.y);
#ifdef TAKES_AWAY
    light -= bright(fetch_or_zero(before, before_region, place + after_region.xy).rgb);
#endif
    return light;
}

bool is_dark(ivec2 place) {
    return any(lessThan(place, ivec2(0))) || any(greaterThanEqual(place, after_region.zw));
}

// The largest channel of the texel's pixels, but for those that objects left as they were: there the difference is 0.
float brightest(ivec2 first) {
    // A texel that the region's edge cuts through looks at whole pixels inside of it instead: its own are among them.
    first = clamp(first, ivec2(0), after_region.zw - SCALE);
    ivec2 first_before = first + after_region.xy - before_region.xy;
    vec3 most = vec3(0.0);
    for (int y = 0; y < SCALE; ++y) {
        for (int x = 0; x < SCALE; ++x) {
            vec4 with_objects = texelFetch(after, first + ivec2(x, y), 0);
            vec3 larger = with_objects.rgb;
#ifdef TAKES_AWAY
            vec3 without = texelFetch(before, first_before + ivec2(x, y), 0).rgb;
            if (with_objects.a == 0.0 && with_objects.rgb == without) continue;
            larger = max(larger, without);
#endif
            most = max(most, larger);
        }
    }
    return max(most.r, max(most.g, most.b));
}

void main() {
    ivec2 first = target_texel() * SCALE - after_region.xy;
    // Most texels have no bright light and end here: on a processor that is what the pass costs.
    bool is_whole = all(greaterThanEqual(after_region.zw, ivec2(SCALE)));
    if (is_whole && brightest(first) <= threshold - knee_half_width) discard;
    vec3 sum = vec3(0.0);
#ifdef FIREFLY_LIMIT
    // Blocks count from the frame's corner, so that every scale weighs a pixel alike.
    const int step_px = SCALE < BLOCK ? SCALE : BLOCK;
    for (int part_y = 0; part_y < SCALE; part_y += step_px) {
        for (int part_x = 0; part_x < SCALE; part_x += step_px) {
            ivec2 part = first + ivec2(part_x, part_y);
            ivec2 in_frame = part + after_region.xy;
            ivec2 block = part - (in_frame - (in_frame / BLOCK) * BLOCK);
            vec3 weighted = vec3(0.0);
            float weights = 0.0;
            for (int y = 0; y < BLOCK; ++y) {
                for (int x = 0; x < BLOCK; ++x) {
                    ivec2 place = block + ivec2(x, y);
                    vec3 light = is_dark(place) ? vec3(0.0) : difference_at(place);
                    vec3 size = abs(light);
                    float weight = 1.0 / (1.0 + max(size.r, max(size.g, size.b)) * (1.0 / FIREFLY_LIMIT));
                    weights += weight;
                    ivec2 in_part = place - part;
                    if (all(greaterThanEqual(in_part, ivec2(0))) && all(lessThan(in_part, ivec2(step_px)))) {
                        weighted += weight * light;
                    }
                }
            }
            sum += weighted * (float(BLOCK * BLOCK) / weights);
        }
    }
#else
    for (int y = 0; y < SCALE; ++y) {
        for (int x = 0; x < SCALE; ++x) {
            ivec2 place = first + ivec2(x, y);
            if (!is_dark(place)) sum += difference_at(place);
        }
    }
#endif
    difference = vec4(clamp(sum * (1.0 / float(SCALE * SCALE)), -largest_half, largest_half), 0.0);
    if (difference.rgb != vec3(0.0)) meet_condition();
}
