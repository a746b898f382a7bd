// Light from the probe: irradiance by spherical harmonics, reflections from prefiltered levels (render/environment.h).
#include "common/mappings.glsl"

layout(binding = 5) uniform samplerCube environment_cube;
layout(binding = 6) uniform sampler2D split_sum_table;
layout(binding = 7) uniform sampler2D environment_sphere_map;

// Factors of 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y² in the irradiance, cosine convolution included.
uniform vec3 irradiance_terms[9];
uniform float last_level;
// Levels a halving of roughness goes back by; see roughness_of_level in environment.cpp.
uniform float levels_per_octave;
uniform float first_roughness;

// Irradiance over π: what a white diffuse surface sends back. Order 2 rings below zero opposite to a strong light
// (Sloan 2008, "Stupid Spherical Harmonics Tricks"); there is no negative light.
vec3 diffuse_radiance(vec3 n) {
    vec3 irradiance = irradiance_terms[0] + irradiance_terms[1] * n.y + irradiance_terms[2] * n.z +
                      irradiance_terms[3] * n.x + irradiance_terms[4] * (n.x * n.y) + irradiance_terms[5] * (n.y * n.z) +
                      irradiance_terms[6] * (3.0 * n.z * n.z - 1.0) + irradiance_terms[7] * (n.x * n.z) +
                      irradiance_terms[8] * (n.x * n.x - n.y * n.y);
    return max(irradiance, vec3(0.0)) / pi;
}

// The level that holds the lobe of a roughness. Below the first rough level the variances of the two lobes are mixed,
// which go with the fourth power of roughness.
float level_of_roughness(float roughness) {
    if (roughness <= first_roughness) return pow(roughness / first_roughness, 4.0);
    return min(last_level + levels_per_octave * log2(roughness), last_level);
}

vec3 reflected_radiance(vec3 direction, float roughness) {
    return textureLod(environment_cube, direction, level_of_roughness(roughness)).rgb;
}

// Scale and bias of F0 (Karis 2013).
vec2 split_sum(float n_dot_v, float roughness) {
    return textureLod(split_sum_table, vec2(n_dot_v, roughness), 0.0).rg;
}
