#version 450 core
// The light of what was taken from the lists and is no sphere (surface/listed.glsl).
#include "spheres/no_sphere.glsl"

uniform usampler2D taken;
uniform sampler2D taken_depth;
layout(std430, binding = 5) readonly buffer ListedLight { uvec2 listed_light[]; };

layout(location = 0) out vec4 light;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint number = texelFetch(taken, pixel, 0).r;
    if (number < no_sphere) discard;
    uvec2 halves = listed_light[number - no_sphere];
    light = vec4(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y));
    gl_FragDepth = texelFetch(taken_depth, pixel, 0).r;
}
