#version 450 core
// One face of the mirror level of the environment: the lat-long image averaged over each texel by a grid of samples.
#include "common/mappings.glsl"

layout(binding = 0) uniform sampler2D latlong;
uniform int face = 0;
uniform int samples_across = 2;

in vec2 uv;
layout(location = 0) out vec4 radiance;

void main() {
    vec2 texel = vec2(abs(dFdx(uv.x)), abs(dFdy(uv.y)));
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    for (int j = 0; j < samples_across; ++j) {
        for (int i = 0; i < samples_across; ++i) {
            vec2 offset = (vec2(i, j) + 0.5) / float(samples_across) - 0.5;
            vec3 toward = cube_direction(face, uv + offset * texel);
            // Solid angle of a patch of the cube's face, up to a constant: 1/distance³.
            float solid_angle = pow(dot(toward, toward), -1.5);
            sum += solid_angle * textureLod(latlong, latlong_uv(normalize(toward)), 0.0).rgb;
            weight += solid_angle;
        }
    }
    radiance = vec4(sum / weight, 1.0);
}
