#version 450 core
// One class behind those nearer than it, or what is sharp. Links with effects/depth_of_field/gather_tile.vert.
//
// Coverages add up to 1, they do not multiply: two classes that meet within a pixel are mostly the two sides of one
// surface, which leaves no gap; and where a near disc covers a part, what is behind it is there as a whole to fill the
// rest.

#include "common/graph.glsl"

// Plate pixels along a texel of the class; 0: what is sharp.
#ifndef CLASS_SCALE
#define CLASS_SCALE 1
#endif

#ifndef ALONE  // in its tile: nothing is nearer, and nothing farther
flat in int is_last_of_tile;
flat in int follows_next;
uniform sampler2D nearer;           // what the target holds
uniform sampler2D nearer_required;
#endif
uniform sampler2D light_behind;     // gather.frag, or `sharp` of gather_resolve.frag; reaches beyond the target
uniform ivec4 light_behind_region;
uniform sampler2D required_behind;

layout(location = 0) out vec4 light;      // premultiplied; a = coverage
#ifndef ALONE
layout(location = 1) out vec2 required;   // coverage that the light is raised to, r: once all is in it; g: once the
                                          // next class is
#endif

// Rounding of a full coverage is none to correct.
const float rounding = 1e-4;

// Bilinear between texels; where they are the pixels themselves, those.
vec4 at_pixel(sampler2D source) {
#if CLASS_SCALE > 1
    vec2 position = (vec2(target_texel()) + 0.5) / float(CLASS_SCALE) - 0.5;
    ivec2 low = ivec2(floor(position));
    vec2 t = position - vec2(low);
    low -= light_behind_region.xy;
    return mix(mix(texelFetch(source, low, 0), texelFetch(source, low + ivec2(1, 0), 0), t.x),
               mix(texelFetch(source, low + ivec2(0, 1), 0), texelFetch(source, low + ivec2(1, 1), 0), t.x), t.y);
#else
    return texelFetch(source, target_texel() - light_behind_region.xy, 0);
#endif
}

void require(float coverage) {
    if (light.a > 0.0 && light.a < coverage) light *= coverage / light.a;
}

void main() {
    vec4 behind = at_pixel(light_behind);
    vec2 required_of_class = vec2(0.0);
#if CLASS_SCALE > 0
    required_of_class = at_pixel(required_behind).rg;
#endif
#ifdef ALONE
    light = behind;
    require(max(required_of_class.r, required_of_class.g));
#else
    light = texelFetch(nearer, ivec2(gl_FragCoord.xy), 0);
    required = texelFetch(nearer_required, ivec2(gl_FragCoord.xy), 0).rg;
    // Where a surface crosses from class to class their discs differ: together they cover it all the same, before what it
    // hides shows through.
    if (follows_next == 0) require(required.g);
    float left = 1.0 - light.a;
    light += behind.a > left + rounding ? behind * max(left, 0.0) / behind.a : behind;
    if (follows_next != 0) require(required.g);
    required = vec2(max(required.r, required_of_class.r), required_of_class.g);
    if (is_last_of_tile != 0) require(max(required.r, required.g));
#endif
}
