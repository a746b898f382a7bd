#version 450 core
// What bounces from other objects, and from the rest of its own, to every vertex of a mesh.
layout(local_size_x = 64) in;

#include "effects/bounce_light/gather.glsl"

// Interleaved floats of a vertex: position at 0, normal at 3 (scene/model.h, ModelVertex).
layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 3) buffer Bounced { vec4 bounced[]; };   // irradiance over π

uniform int vertex_count;
uniform int vertex_floats;
uniform int first_vertex;
uniform mat4 world_from_model;
uniform mat3 normal_from_model;

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= vertex_count) return;
    int at = i * vertex_floats;
    vec3 position = (world_from_model * vec4(vertices[at], vertices[at + 1], vertices[at + 2], 1.0)).xyz;
    vec3 normal = normalize(normal_from_model * vec3(vertices[at + 3], vertices[at + 4], vertices[at + 5]));
    vec3 before = first_ray > 0 ? bounced[first_vertex + i].rgb : vec3(0.0);
    bounced[first_vertex + i] = vec4(before + gathered(position, normal, true), 1.0);
}
