#version 450 core
// The nearest triangle along rays, for the test of common/rays.glsl.
layout(local_size_x = 64) in;

#include "common/rays.glsl"

layout(std430, binding = 0) readonly buffer Rays { vec4 rays[]; };   // origin, direction
layout(std430, binding = 1) writeonly buffer Hits { vec4 hits[]; };  // distance (−1: none), where it met

uniform int ray_count;

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= ray_count) return;
    vec3 origin = rays[2 * i].xyz, direction = rays[2 * i + 1].xyz;
    RayHit hit = nearest_hit(origin, direction, 3.4e38);
    hits[i] = vec4(-1.0);
    if (hit.instance < 0) return;
    RaySurface surface = surface_at(hit, origin, direction);
    hits[i] = vec4(hit.distance_m, surface.world_position);
}
