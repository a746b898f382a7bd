#version 450 core
// The depths of the next layers at both ends, of what lies between the last ones and of what is left at these.

uniform sampler2D depths;   // nearest, farthest
uniform usampler2D last;    // taken off at these depths before
uniform sampler2D between;  // nearest, −farthest, below 0 where nothing is
uniform usampler2D near_id, far_id, near_count, far_count;
uniform sampler2D covered;  // by the layers in front: alpha
uniform float enough;

layout(location = 0) out vec2 next_depths;
layout(location = 1) out uvec2 next_last;

const uint none = 0xFFFFFFFFu;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 ends = texelFetch(depths, pixel, 0).rg, inner = texelFetch(between, pixel, 0).rg;
    uvec2 taken = texelFetch(last, pixel, 0).rg;
    bool near_is_left = texelFetch(near_count, pixel, 0).r > 1u, far_is_left = texelFetch(far_count, pixel, 0).r > 1u;
    next_depths = vec2(inner.x, -inner.y);
    next_last = uvec2(0u, none);
    if (near_is_left) {
        next_depths.x = ends.x;
        next_last.x = texelFetch(near_id, pixel, 0).r;
        // All that are left lie there: those beyond the last one that was taken off from the other end are gone.
        if (ends.x == ends.y) next_last.y = taken.y;
    }
    if (far_is_left) {
        next_depths.y = ends.y;
        next_last.y = texelFetch(far_id, pixel, 0).r;
    }
    if (inner.x < 0.0) {
        // Nothing between: one end has both.
        if (!near_is_left) next_depths.x = far_is_left ? ends.y : -1.0;
        if (!far_is_left) next_depths.y = near_is_left ? ends.x : -1.0;
    }
    if (texelFetch(covered, pixel, 0).a >= enough) next_depths = vec2(-1.0);
}
