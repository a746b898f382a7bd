#version 450 core
// The light that every vertex of all meshes sends out diffusely: what arrives there, times what is not mirrored, and its
// own.
layout(local_size_x = 64) in;

#include "common/environment.glsl"
#include "common/rays.glsl"
#include "common/scattering.glsl"

layout(std430, binding = 0) readonly buffer Direct { vec4 direct[]; };       // irradiance over π
layout(std430, binding = 1) readonly buffer Emission { vec4 emission[]; };
layout(std430, binding = 2) writeonly buffer Radiosity { vec4 radiosity[]; };
layout(std430, binding = 3) readonly buffer Bounced { vec4 bounced[]; };     // irradiance over π

uniform int vertex_count;
uniform bool has_bounced;

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= vertex_count) return;
    vec3 light = direct[i].rgb;
    if (has_bounced) light += bounced[i].rgb;
    // Seen from everywhere: the mean cosine over a hemisphere, weighed by itself, is 2/3.
    const float mean_cosine = 2.0 / 3.0;
    vec4 base_metallic = ray_vertex_base_metallic(i);
    vec2 table = split_sum(mean_cosine, ray_vertex_normal_roughness(i).w);
    radiosity[i] = vec4(light * material_scattering(base_metallic.rgb, base_metallic.a, table).diffuse + emission[i].rgb, 1.0);
}
