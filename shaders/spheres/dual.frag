#version 450 core
// Spheres between the nearest and the farthest depth that are left: their depths at both ends, by blending; and which
// lie at these depths themselves. Links with spheres/sphere.vert.
#include "spheres/meet.glsl"

layout(early_fragment_tests) in;

uniform sampler2D depths;  // nearest, farthest (near_m / z: larger is nearer)
uniform usampler2D last;   // which was taken off last at the nearest (0: none) and at the farthest depth (all bits: none)

layout(binding = 2, r32ui) uniform uimage2D near_id;
layout(binding = 3, r32ui) uniform uimage2D far_id;
layout(binding = 4, r32ui) uniform uimage2D near_count;
layout(binding = 5, r32ui) uniform uimage2D far_count;

layout(location = 0) out vec2 between;  // the greatest of both: depth, −depth

void main() {
    float depth = meet_depth();
    if (depth < 0.0) discard;
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    // The same program finds the same depths, to the last bit.
    vec2 ends = texelFetch(depths, pixel, 0).rg;
    if (depth > ends.x || depth < ends.y) discard;
    if (depth < ends.x && depth > ends.y) {
        between = vec2(depth, -depth);
        return;
    }
    uvec2 taken = texelFetch(last, pixel, 0).rg;
    bool is_left = (depth < ends.x || sphere_id > taken.x) && (depth > ends.y || sphere_id < taken.y);
    if (!is_left) discard;
    if (depth == ends.x) {
        imageAtomicMin(near_id, pixel, sphere_id);
        imageAtomicAdd(near_count, pixel, 1u);
    } else {
        imageAtomicMax(far_id, pixel, sphere_id);
        imageAtomicAdd(far_count, pixel, 1u);
    }
    between = vec2(-1.0);
}
