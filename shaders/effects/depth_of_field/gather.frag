#version 450 core
// Every texel collects what the discs of its neighbours send it.

#include "common/graph.glsl"

#ifndef TAPS
#define TAPS 1
#endif

uniform sampler2D light_share;
uniform sampler2D discs;
uniform ivec4 discs_region;
uniform sampler2D widest;       // disc of a tile and of those around it (gather_tiles.frag)
uniform ivec4 widest_region;
uniform int tile_texels;
uniform int is_far;             // beyond the focus, where wider discs are farther away
uniform vec4 taps[TAPS];        // offset in texels, distance in units of the disc's radius; nearest first
uniform int tap_count;          // TAPS, not known beforehand: an unrolled loop would not end early

layout(location = 0) out vec4 light;      // premultiplied
layout(location = 1) out vec2 required;   // coverage that the discs' surroundings leave no doubt about: of all that is
                                          // seen, and of this class with those next to it

void main() {
    ivec2 texel = target_texel();
    light = vec4(0.0);
    required = vec2(0.0);
    ivec2 tile = ivec2(floor(vec2(texel) / float(tile_texels)));
    float reach = texelFetch(widest, tile - widest_region.xy, 0).r;

    ivec2 place = texel - discs_region.xy;
    float own = texelFetch(discs, place, 0).r;
    float seen = 0.0;
    vec2 covered = vec2(0.0);
    for (int i = 0; i < tap_count; ++i) {
        float distance = taps[i].z - 0.5;
        if (distance > reach) break;
        ivec2 there = place + ivec2(taps[i].xy);
        vec3 disc = texelFetch(discs, there, 0).rgb;
        // What is behind the texel's own surface shows no farther through it than that is blurred itself; a surface that
        // slants away is not behind itself.
        float radius = is_far != 0 && own > 0.0 ? min(disc.r, 1.25 * own) : disc.r;
        light += clamp(radius - distance, 0.0, 1.0) * texelFetch(light_share, there, 0);
        float share = clamp(own - distance, 0.0, 1.0);
        seen += share;
        covered += share * disc.gb;
    }
    // Behind a texel's own disc there is nothing empty where all that it spans is covered: what is missing there is
    // hidden from the picture, not absent.
    if (own > 0.0) required = covered / seen;
}
