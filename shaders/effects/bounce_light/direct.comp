#version 450 core
// The light that arrives from the probe at every vertex of a mesh, past the objects that stand in its way.
layout(local_size_x = 64) in;

#include "common/environment.glsl"

// Interleaved floats of a vertex: normal at 3 (scene/model.h, ModelVertex).
layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) readonly buffer Visibility { vec4 visibility[]; };
layout(std430, binding = 2) writeonly buffer Direct { vec4 direct[]; };   // irradiance over π

uniform int vertex_count;
uniform int vertex_floats;
uniform int first_vertex;
uniform bool has_visibility;
uniform mat3 normal_from_model;

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= vertex_count) return;
    int at = i * vertex_floats;
    vec3 normal = normalize(normal_from_model * vec3(vertices[at + 3], vertices[at + 4], vertices[at + 5]));
    vec3 light = diffuse_radiance(normal);
    if (has_visibility) light *= visibility[i].rgb;
    direct[first_vertex + i] = vec4(light, 1.0);
}
