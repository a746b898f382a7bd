#version 450 core
// The object shadow at every vertex of a mesh: static objects under static light need it once.
layout(local_size_x = 64) in;

#include "common/environment.glsl"
#include "effects/object_shadow/object_shadow.glsl"

// Interleaved floats of a vertex: position at 0, normal at 3 (scene/model.h, ModelVertex).
layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) writeonly buffer Visibility { vec4 visibility[]; };

uniform int vertex_count;
uniform int vertex_floats;
uniform mat4 world_from_model;
uniform mat3 normal_from_model;
uniform bool is_real;

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= vertex_count) return;
    int at = i * vertex_floats;
    vec3 position = vec3(vertices[at], vertices[at + 1], vertices[at + 2]);
    vec3 normal = vec3(vertices[at + 3], vertices[at + 4], vertices[at + 5]);
    vec3 world_position = (world_from_model * vec4(position, 1.0)).xyz;
    visibility[i] = vec4(object_shadow(world_position, normalize(normal_from_model * normal), is_real), 1.0);
}
