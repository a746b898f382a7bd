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
uniform sampler2D tiles;  // of slice_tiles.frag
uniform ivec4 tiles_region;
uniform int tile;         // texels along a side
uniform int reach_tiles;  // of the opening

layout(location = 0) out vec4 blurred;

bool anything_within_reach(ivec2 texel) {
    ivec2 middle = texel / tile;
    for (int y = -reach_tiles; y <= reach_tiles; ++y) {
        for (int x = -reach_tiles; x <= reach_tiles; ++x) {
            if (fetch_or_zero(tiles, tiles_region, middle + ivec2(x, y)).r > 0.0) return true;
        }
    }
    return false;
}

void main() {
    ivec2 texel = target_texel();
    blurred = vec4(0.0);
    if (!anything_within_reach(texel)) return;
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
