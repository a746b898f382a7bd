#version 450 core
// The environment as the image of a mirror ball, for the classic sphere-map lookup.
#include "common/mappings.glsl"

layout(binding = 0) uniform sampler2D latlong;

in vec2 uv;
layout(location = 0) out vec4 radiance;

void main() {
    radiance = vec4(textureLod(latlong, latlong_uv(sphere_map_direction(uv)), 0.0).rgb, 1.0);
}
