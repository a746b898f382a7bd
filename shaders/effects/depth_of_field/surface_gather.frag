#version 450 core
// The mean of what the lens sees of the surface through all its opening, of one class of circles.
//
// A pixel p sees through the point l of the opening (|l| ≤ 1/2) the surface's point at pixel q, of circle c(q):
// q = p − c(q) l. With c affine about p, l = (p − q) / c(q) and dl = |c(p) / c(q)³| dq: what each texel counts.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "effects/contact_shadow/contact_shadow.glsl"
#include "composite/shadow.glsl"
#include "effects/depth_of_field/surface_circle.glsl"

#ifndef TAPS
#define TAPS 1
#endif

uniform sampler2D loss;       // has room for all taps
uniform ivec4 loss_region;
uniform sampler2D discs;      // radius of the drawn disc by that of the disc, in texels
uniform int discs_row;
uniform float discs_step;
uniform int texel_px;
uniform int drawn_class;
uniform float most_stretch;

uniform vec4 taps[TAPS];      // offset in texels, distance in units of the disc's radius; nearest first, as from beyond
                              // the focus

layout(location = 0) out vec4 blurred;

bool is_needed(float width_px, vec2 change) {
    // Pixels next to one of this class look at this texel, too.
    float slack_px = 2.0 * float(texel_px) * (abs(change.x) + abs(change.y)) + 0.01 * width_px;
    return surface_class(width_px + slack_px) >= drawn_class &&
           surface_class(max(width_px - slack_px, 0.0)) <= drawn_class;
}

void main() {
    ivec2 texel = target_texel();
    SurfaceCircle circle = surface_circle((vec2(texel) + 0.5) * float(texel_px) - 0.5);
    float width_px = abs(circle.coc_px);
    if (isnan(width_px) || !is_needed(width_px, circle.change)) discard;
    float at = min(0.5 * width_px / float(texel_px) / discs_step, float(textureSize(discs, 0).x) - 1.001);
    float radius = mix(texelFetch(discs, ivec2(int(at), discs_row), 0).r,
                       texelFetch(discs, ivec2(int(at) + 1, discs_row), 0).r, fract(at));
    // Before the focus the opening is seen turned.
    float turn = circle.coc_px < 0.0 ? -1.0 : 1.0;
    vec2 growth = turn * circle.change * float(texel_px) / circle.coc_px;  // a texel's step
    float farthest = (radius + 0.5) * most_stretch;
    vec3 sum = vec3(0.0);
    float whole = 0.0;
    ivec2 place = texel - loss_region.xy;
    int way = int(turn);
    for (int i = 0; i < TAPS; ++i) {
        float distance = taps[i].z;
        if (distance > farthest) break;
        float grown = max(1.0 + dot(growth, taps[i].xy), 0.25);  // circle there over circle here
        float share = clamp(radius * grown + 0.5 - distance, 0.0, 1.0) / (grown * grown * grown);
        sum += share * texelFetch(loss, place + way * ivec2(taps[i].xy), 0).rgb;
        whole += share;
    }
    blurred = vec4(sum / whole, 0.0);
}
