#version 450 core
// What the objects send to points of the real surface, as a share of its unshadowed light.
layout(local_size_x = 8, local_size_y = 8) in;

#include "effects/bounce_light/gather.glsl"

layout(rgba32f, binding = 0) uniform image2D share;

uniform vec4 rectangle_m;           // min x, min y, width, height on the surface
uniform vec3 surface_irradiance;    // from above, without the objects

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(share);
    if (any(greaterThanEqual(texel, size))) return;
    vec2 at = rectangle_m.xy + (vec2(texel) + 0.5) / vec2(size) * rectangle_m.zw;
    vec3 before = first_ray > 0 ? imageLoad(share, texel).rgb : vec3(0.0);
    vec3 arrives = pi * gathered(vec3(at, surface_z_m), vec3(0.0, 0.0, 1.0), false);
    imageStore(share, texel, vec4(before + arrives / max(surface_irradiance, vec3(1e-20)), 0.0));
}
