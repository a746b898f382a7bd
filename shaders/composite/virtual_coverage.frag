#version 450 core
// Light of virtual things with the coverage that is theirs, without that of real things among them.

#include "common/graph.glsl"

uniform sampler2D light;      // a: coverage of real and virtual things
uniform ivec4 light_region;
uniform sampler2D coverage;   // r: of virtual things
uniform ivec4 coverage_region;

layout(location = 0) out vec4 virtual_light;

void main() {
    virtual_light = vec4(fetch_or_zero(light, light_region, target_texel()).rgb,
                         clamp(fetch_or_zero(coverage, coverage_region, target_texel()).r, 0.0, 1.0));
}
