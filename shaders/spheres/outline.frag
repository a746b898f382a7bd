#version 450 core
// The outline of the sphere that a pixel shows, where its neighbours show something else.
#include "spheres/neighbours.glsl"
#include "spheres/ray.glsl"

uniform sampler2D seen_depth;   // near_m / z

uniform samplerBuffer spheres;  // centre, radius
uniform uint first_id, end_id;  // of the set
uniform vec3 eye_high, eye_low; // in the set's axes
uniform mat3 camera_from_model, camera_from_model_low; // of directions, with the set's scale; what floats left of it

layout(location = 0) out vec4 outline;  // centre in camera axes (x right, y up, z forward) in metres; the tangent of its angular radius

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint id = texelFetch(seen_spheres, pixel, 0).r;
    if (id < first_id || id >= end_id || !is_at_edge(pixel, id)) discard;
    vec4 sphere = texelFetch(spheres, int(id - first_id));
    dvec3 centre = dvec3(sphere.xyz) - dvec3(eye_high) - dvec3(eye_low);
    vec3 met = near_plane_m / texelFetch(seen_depth, pixel, 0).r * ray_direction(picture_ndc());
    sphere.w = drawn_radius(vec4(-centre, sphere.w), met);
    // Near a surface the two squares have nearly all digits in common.
    float power = float(dot(centre, centre) - double(sphere.w) * double(sphere.w));
    // From inside it is all around.
    const float all_around = -1.0;
    outline = vec4((dmat3(camera_from_model) + dmat3(camera_from_model_low)) * centre, power > 0.0 ? sphere.w / sqrt(power) : all_around);
}
