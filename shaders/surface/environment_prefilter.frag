#version 450 core
// One face of a rough level of the environment: radiance under the GGX lobe seen along its axis (normal, view and
// reflection equal: Karis 2013, "Real Shading in Unreal Engine 4"), by filtered importance sampling (Křivánek & Colbert
// 2008, "Real-time Shading with Filtered Importance Sampling"): each sample reads the mip level as wide as its share.
#include "common/mappings.glsl"

#ifndef MOST_SAMPLES
#define MOST_SAMPLES 512
#endif

layout(binding = 0) uniform samplerCube mirror;
uniform int face = 0;
// Reflected directions about +z and, in w, the mip level; the weight is the direction's z.
uniform vec4 lobe[MOST_SAMPLES];
uniform int sample_count = 1;

in vec2 uv;
layout(location = 0) out vec4 radiance;

// An orthonormal basis without branches on all three axes (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
mat3 basis_around(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

void main() {
    mat3 world_from_lobe = basis_around(normalize(cube_direction(face, uv)));
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    for (int i = 0; i < sample_count; ++i) {
        vec4 sampled = lobe[i];
        vec3 direction = world_from_lobe * sampled.xyz;
        vec3 along = abs(direction);
        // Texels shrink towards the corners of a face, in solid angle with the cube of the largest component.
        float level = sampled.w - 1.5 * log2(max(along.x, max(along.y, along.z)));
        sum += sampled.z * textureLod(mirror, direction, level).rgb;
        weight += sampled.z;
    }
    radiance = vec4(sum / weight, 1.0);
}
