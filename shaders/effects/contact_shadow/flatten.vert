#version 450 core
// Casters flattened onto the surface along one direction of light (Blinn 1988, "Me and My (Fake) Shadow").

layout(location = 0) in vec3 position;

uniform mat4 world_from_model;
uniform vec3 direction_to_light;  // unit, world; z > 0
uniform float surface_z_m;
uniform vec2 rectangle_min_m;
uniform vec2 rectangle_size_m;

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[1];
};

void main() {
    vec3 world = (world_from_model * vec4(position, 1.0)).xyz;
    float height_m = world.z - surface_z_m;
    vec2 on_surface = world.xy - direction_to_light.xy * (height_m / direction_to_light.z);
    vec2 share = (on_surface - rectangle_min_m) / rectangle_size_m;
    gl_Position = vec4(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);  // row 0 holds the smallest y
    gl_ClipDistance[0] = height_m;  // what lies under the surface casts nothing on it
}
