#version 450 core
// Casters seen from one direction of light, over their bounding sphere; depth 1 is nearest to the light.

layout(location = 0) in vec3 position;

uniform mat4 world_from_model;
uniform vec3 centre_m;
uniform float radius_m;
uniform vec3 direction_to_light;
uniform vec3 axis_u;
uniform vec3 axis_v;

void main() {
    vec3 from_centre = ((world_from_model * vec4(position, 1.0)).xyz - centre_m) / radius_m;
    float height = dot(from_centre, direction_to_light) * 0.5 + 0.5;
    // Row 0 of the map holds the most negative v.
    gl_Position = vec4(dot(from_centre, axis_u), -dot(from_centre, axis_v), height, 1.0);
}
