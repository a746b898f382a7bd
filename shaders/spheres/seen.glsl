// What a pixel sees of a set of spheres, of which a picture was made before or (DRAWN) one is drawn: in place of what a
// mesh's vertices tell.
#include "spheres/ray.glsl"
#ifdef DRAWN
#include "spheres/meet.glsl"
// The true depth lies behind the front of what sphere.vert draws.
layout(depth_less) out float gl_FragDepth;
#else
uniform usampler2D seen_spheres;   // which sphere (spheres/visible.frag)
uniform sampler2D seen_depth;      // near_m / z
uniform uint end_id;               // of the set
#endif
uniform uint first_id;

uniform samplerBuffer spheres;     // centre, radius
uniform samplerBuffer sphere_colors;  // sRGB-coded
uniform samplerBuffer sphere_opacities;
uniform bool has_sphere_colors, has_sphere_opacities;
uniform vec3 eye_high, eye_low;    // in the set's axes
uniform mat4 world_from_model;
uniform bool is_long_lens;         // floats do not tell a pixel's ray from the next one's
#ifndef LONG_LENS
uniform mat3 ray_from_ndc_low;     // what floats left of ray_from_ndc
#endif

vec3 model_position, world_position, world_normal;
const vec4 world_tangent = vec4(0.0);
const vec2 material_uv = vec2(0.0);
vec4 vertex_color;
float fragment_depth;      // as the depth buffer has it
const bool front_facing = true;

vec4 sphere_from_eye;      // the eye less the centre, radius
vec3 sphere_from_eye_low;  // is_long_lens: what floats left of it
bool sees_inside;          // the farther side of it

// The place next to the sphere's centre on a ray.
vec3 foot_on_ray(vec2 ndc, vec3 direction) {
    if (!is_long_lens) return sphere_from_eye.xyz - (dot(sphere_from_eye.xyz, direction) / dot(direction, direction)) * direction;
    dvec3 from_centre = dvec3(sphere_from_eye.xyz) + dvec3(sphere_from_eye_low);
    dvec3 ray = (dmat3(ray_from_ndc) + dmat3(ray_from_ndc_low)) * dvec3(ndc, 1.0);
    return vec3(from_centre - (dot(from_centre, ray) / dot(ray, ray)) * ray);
}

// From the centre to where a ray meets the sphere, or to its rim where it passes by.
vec3 place_on_sphere(vec2 ndc) {
    vec3 direction = ray_direction(ndc);
    float a = dot(direction, direction);
    vec3 foot = foot_on_ray(ndc, direction);
    float left = max((sphere_from_eye.w - length(foot)) * (sphere_from_eye.w + length(foot)), 0.0);
    float half_chord = sqrt(left / a);
    if (is_long_lens) sees_inside = -dot(sphere_from_eye.xyz, direction) / a - half_chord < near_plane_m;
    return sees_inside ? foot + half_chord * direction : foot - half_chord * direction;
}

// On the side of the eye.
vec3 sphere_normal(vec3 place) { return normalize(mat3(world_from_model) * (sees_inside ? -place : place)); }

float linear_from_srgb(float code) { return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4); }

// False where the pixel sees nothing of this set.
bool see() {
#ifdef DRAWN
    int number = int(sphere_id - first_id);
    fragment_depth = meet_depth();
    if (fragment_depth < 0.0) return false;
#else
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint id = texelFetch(seen_spheres, pixel, 0).r;
    if (id < first_id || id >= end_id) return false;
    int number = int(id - first_id);
    fragment_depth = texelFetch(seen_depth, pixel, 0).r;
#endif
    vec4 sphere = texelFetch(spheres, number);
    sphere_from_eye = vec4((eye_high - sphere.xyz) + eye_low, sphere.w);
    if (is_long_lens) {
        dvec3 exact = dvec3(eye_high) - dvec3(sphere.xyz) + dvec3(eye_low);
        sphere_from_eye_low = vec3(exact - dvec3(sphere_from_eye.xyz));
    }
    vec3 direction = ray_direction(picture_ndc());
    float z_m = near_plane_m / fragment_depth;
    sees_inside = z_m * dot(direction, direction) > -dot(sphere_from_eye.xyz, direction);
    sphere_from_eye.w = drawn_radius(sphere_from_eye, z_m * direction);
    vec3 place = place_on_sphere(picture_ndc());
    world_normal = sphere_normal(place);
    // So narrow a view tells places by the sphere's centre better than by the eye.
    model_position = is_long_lens ? sphere.xyz + place : eye_high + (eye_low + z_m * direction);
    world_position = (world_from_model * vec4(model_position, 1.0)).xyz;
    vertex_color = vec4(1.0);
    if (has_sphere_colors) {
        vec3 code = texelFetch(sphere_colors, number).rgb;
        vertex_color.rgb = vec3(linear_from_srgb(code.r), linear_from_srgb(code.g), linear_from_srgb(code.b));
    }
    if (has_sphere_opacities) vertex_color.a = texelFetch(sphere_opacities, number).r;
    gl_FragDepth = fragment_depth;
    return true;
}

float inverse_z() { return fragment_depth / near_plane_m; }

// How a mirror image moves with a pixel to the right and one down, on this sphere.
void reflected_steps(vec3 reflected, out vec3 dx, out vec3 dy) {
    for (int axis = 0; axis < 2; ++axis) {
        vec2 pixel = gl_FragCoord.xy + (axis == 0 ? vec2(1.0, 0.0) : vec2(0.0, 1.0));
        vec2 ndc = ndc_of(pixel);
        vec3 direction = ray_direction(ndc);
        vec3 normal = sphere_normal(place_on_sphere(ndc));
        vec3 step = reflect(normalize(mat3(world_from_model) * direction), normal) - reflected;
        if (axis == 0) dx = step;
        else dy = step;
    }
}
