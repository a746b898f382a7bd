#version 450 core
// Casters flattened onto the surface from one point of a lamp (Blinn 1988, "Me and My (Fake) Shadow").

layout(location = 0) in vec3 position;

uniform mat4 world_from_model;
uniform mat4 clip_from_world;
uniform float surface_z_m;

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[1];
};

void main() {
    vec4 world = world_from_model * vec4(position, 1.0);
    gl_Position = clip_from_world * world;
    gl_Position.z = 0.5 * gl_Position.w;  // what is nearer to the lamp than any plane hides light, too
    gl_ClipDistance[0] = world.z - surface_z_m;  // what lies under the surface casts nothing on it
}
