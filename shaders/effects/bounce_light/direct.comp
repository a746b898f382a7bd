#version 450 core
// The light that arrives from the probe and from lamps at every vertex of a mesh, past the objects that stand in its way.
layout(local_size_x = 64) in;

#include "common/environment.glsl"
#ifdef LAMPS
#define RAYS
#define AT_VERTICES
#include "common/lamps.glsl"
#include "common/visibility.glsl"
#include "common/rays.glsl"
#include "common/lamp_shadow.glsl"
uniform mat4 world_from_model;
#endif

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
#ifdef LAMPS
    vec3 world_position = (world_from_model * vec4(vertices[at], vertices[at + 1], vertices[at + 2], 1.0)).xyz;
    for (int i_lamp = 0; i_lamp < lamp_count; ++i_lamp) {
        Lamp lamp = lamps[i_lamp];
        LampLight arrives = lamp_light(lamp, world_position);
        float cosine = dot(normal, arrives.to_lamp);
        if (lamp_has(lamp, lamp_of_probe) || cosine <= 0.0) continue;
        light += lamp_share_left(lamp, arrives, world_position, normal, normal) * cosine * arrives.irradiance / pi;
    }
#endif
    direct[first_vertex + i] = vec4(light, 1.0);
}
