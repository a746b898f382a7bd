#version 450 core
// A model's vertices, for shading and for the layers.
layout(location = 0) in vec3 position;  // metres, the model's own axes
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;  // w: handedness
layout(location = 3) in vec2 texture_uv;
layout(location = 4) in vec4 color;
layout(location = 5) in vec4 visibility;  // 1 where none was baked
#ifdef UV_MAPPINGS
layout(location = 6) in vec2 texture_uv_second;
out vec2 material_uv_second;
#endif

#if defined(PATTERN) && !defined(PATTERN_UV)
out vec3 object_position;
#endif

uniform mat4 clip_from_model;  // multiplied in double precision on the CPU
uniform mat4 world_from_model;
uniform mat3 normal_from_model;  // inverse transpose

out vec3 world_position;
out vec3 world_normal;
out vec4 world_tangent;
out vec2 material_uv;
out vec4 vertex_color;
out vec3 vertex_visibility;
#ifdef RAYS
// Over all meshes (render/ray_scene.h).
uniform samplerBuffer ray_bounced;
uniform int first_vertex;
out vec3 vertex_bounce;
#endif

// Drawn again by another program, a vertex is where it was.
invariant gl_Position;

void main() {
    world_position = (world_from_model * vec4(position, 1.0)).xyz;
    world_normal = normal_from_model * normal;
    world_tangent = vec4(mat3(world_from_model) * tangent.xyz, tangent.w);
    material_uv = texture_uv;
#if defined(PATTERN) && !defined(PATTERN_UV)
    object_position = position;
#endif
#ifdef UV_MAPPINGS
    material_uv_second = texture_uv_second;
#endif
    vertex_color = color;
    vertex_visibility = visibility.rgb;
#ifdef RAYS
    vertex_bounce = texelFetch(ray_bounced, first_vertex + gl_VertexID).rgb;
#endif
    gl_Position = clip_from_model * vec4(position, 1.0);
}
