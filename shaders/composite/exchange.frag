#version 450 core
// What other programs ask of the virtual layer beside its light: how it moves, and which parts cover how much.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"

uniform sampler2D way_to_next;       // effects/motion_blur/ways.frag, of the layer's pixels
uniform sampler2D way_to_previous;
uniform sampler2DMS layer_parts;     // number of the part that each sample sees, 0 = none
uniform int sample_count;

layout(location = 0) out vec4 motion;  // change of x/z and y/z to the next frame (xy) and to the previous one (zw)
// Part and coverage, part and coverage: eight of them, in no order.
layout(location = 1) out vec4 parts_0;
layout(location = 2) out vec4 parts_1;
layout(location = 3) out vec4 parts_2;
layout(location = 4) out vec4 parts_3;

const int slots = 8;
float part_of[slots];
float share_of[slots];

// More parts than slots in a pixel: the least of them gives way.
void count(float part, float share) {
    if (part == 0.0) return;
    int least = 0;
    for (int i = 0; i < slots; ++i) {
        if (part_of[i] == part || part_of[i] == 0.0) {
            part_of[i] = part;
            share_of[i] += share;
            return;
        }
        if (share_of[i] < share_of[least]) least = i;
    }
    if (share <= share_of[least]) return;
    part_of[least] = part;
    share_of[least] = share;
}

// Of the object that is nearest in the pixel, the mean over what is seen of it.
float nearest_per_m = 0.0, nearest_object = 0.0, motion_share = 0.0;

// A layer pixel, of which `share` lies in the plate pixel.
void take(ivec2 at, float share) {
    vec4 next = texelFetch(way_to_next, at, 0);
    if (next.w > nearest_per_m && next.z != nearest_object) {
        nearest_object = next.z;
        motion = vec4(0.0);
        motion_share = 0.0;
    }
    if (next.w > 0.0 && next.z == nearest_object) {
        nearest_per_m = max(nearest_per_m, next.w);
        motion += share * vec4(next.xy, texelFetch(way_to_previous, at, 0).xy);
        motion_share += share;
    }
    for (int i = 0; i < sample_count; ++i) count(texelFetch(layer_parts, at, i).r, share / float(sample_count));
}

void main() {
    for (int i = 0; i < slots; ++i) part_of[i] = share_of[i] = 0.0;
    motion = vec4(0.0);
    ivec2 pixel = target_texel();
    vec2 normalized = normalized_from_pixel(vec2(pixel));
    if (layer_present != 0 && !any(isnan(normalized))) {
        // The same pixels with the same weights as layer_over_pixel() takes.
#if LAYER_DENSITY > 0
        ivec2 first = (pixel - layer_first_pixel) * LAYER_DENSITY;
        if (all(greaterThanEqual(first, ivec2(0))) && all(lessThan(first, layer_size))) {
            const float share = 1.0 / float(LAYER_DENSITY * LAYER_DENSITY);
            for (int y = 0; y < LAYER_DENSITY; ++y)
                for (int x = 0; x < LAYER_DENSITY; ++x) take(first + ivec2(x, y), share);
        }
#else
        vec2 footprint = layer_footprint(vec2(pixel), normalized);
        vec2 centre = layer_position(normalized);
        vec2 low = centre - 0.5 * footprint;
        vec2 high = centre + 0.5 * footprint;
        ivec2 first = max(ivec2(floor(low)), ivec2(0));
        ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;
        for (int y = first.y; y <= last.y; ++y) {
            float height = min(high.y, float(y + 1)) - max(low.y, float(y));
            for (int x = first.x; x <= last.x; ++x) {
                float width = min(high.x, float(x + 1)) - max(low.x, float(x));
                take(ivec2(x, y), width * height / (footprint.x * footprint.y));
            }
        }
#endif
    }
    if (motion_share > 0.0) motion /= motion_share;
    parts_0 = vec4(part_of[0], share_of[0], part_of[1], share_of[1]);
    parts_1 = vec4(part_of[2], share_of[2], part_of[3], share_of[3]);
    parts_2 = vec4(part_of[4], share_of[4], part_of[5], share_of[5]);
    parts_3 = vec4(part_of[6], share_of[6], part_of[7], share_of[7]);
}
