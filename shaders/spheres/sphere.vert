#version 450 core
// What a sphere can cover of the picture: a point, or two triangles (TRIANGLES) where it is large or at the picture's
// edge, with the depth of its nearest place. Links with a shader that includes spheres/meet.glsl.

#ifdef TRIANGLES
uniform samplerBuffer spheres;  // centre, radius
#else
layout(location = 0) in vec4 centre_radius;
layout(location = 1) in float radius_scale;  // one that stands for others is larger
#endif

uniform mat4 clip_from_model;   // multiplied in double precision on the CPU
uniform vec3 eye_high, eye_low;  // in the model's axes; their sum has twice a float's digits
uniform vec2 picture_px;
uniform uint first_id;          // of the set's first sphere

#ifdef LONG_LENS
#include "spheres/long_lens.glsl"
#else
flat out vec4 seen_sphere;      // the eye less the centre, radius; PARALLEL: centre in clip space, radius
flat out float power;           // |eye − centre|² − radius²
#endif
flat out uint sphere_id;

const float padding_px = 1.0;   // for rounding
// The depth test may come before the shader that finds the true depth, which must not lie nearer.
const float slack = 1.000001;

void main() {
#ifdef TRIANGLES
    int number = gl_VertexID / 6;
    vec4 centre_radius = texelFetch(spheres, number);
#else
    int number = gl_VertexID;
#endif
    vec3 centre = centre_radius.xyz;
#ifdef TRIANGLES
    float radius = centre_radius.w;
#else
    float radius = centre_radius.w * radius_scale;
#endif
    sphere_id = first_id + uint(number);
    mat4 rows = transpose(clip_from_model);
#ifdef LONG_LENS
    dvec3 from_eye = dvec3(centre) - dvec3(eye_high) - dvec3(eye_low);
    vec4 clip = clip_of(from_eye);
#else
    vec4 clip = clip_from_model * vec4(centre, 1.0);
#endif
    vec2 middle, half_size;
    float depth;
    bool is_everywhere = false;
#ifdef PARALLEL
    seen_sphere = vec4(clip.xyz, radius);
    power = 0.0;
    middle = clip.xy;
    half_size = radius * vec2(length(rows[0].xyz), length(rows[1].xyz));
    depth = clip.z + radius * length(rows[2].xyz);
#else
#ifndef LONG_LENS
    vec3 from_centre = (eye_high - centre) + eye_low;
    seen_sphere = vec4(from_centre, radius);
#ifdef TRIANGLES
    // Near a surface the two squares have nearly all digits in common.
    dvec3 exact = dvec3(eye_high) - dvec3(centre) + dvec3(eye_low);
    power = float(dot(exact, exact) - double(radius) * double(radius));
#else
    float away = length(from_centre);
    power = (away - radius) * (away + radius);
#endif
#endif
    // The box around the projected sphere, by its dual quadric (Sigg, Weyrich, Botsch & Gross 2006, "GPU-Based Ray-Casting of
    // Quadratic Surfaces").
    float reach_w = radius * length(rows[3].xyz);
    float w2 = (clip.w - reach_w) * (clip.w + reach_w);
    vec2 cross_w = clip.xy * clip.w - radius * radius * vec2(dot(rows[0].xyz, rows[3].xyz), dot(rows[1].xyz, rows[3].xyz));
    vec2 squares = clip.xy * clip.xy - radius * radius * vec2(dot(rows[0].xyz, rows[0].xyz), dot(rows[1].xyz, rows[1].xyz));
    middle = cross_w / w2;
    half_size = sqrt(max(cross_w * cross_w - w2 * squares, 0.0)) / w2;
    float nearest_w = clip.w - reach_w;
    depth = min(clip.z * slack / max(nearest_w, 1e-30), 1.0);
    // One that reaches behind the eye may be anywhere, and so may one so large that a float does not tell.
    const float many = 1e3;
    is_everywhere = nearest_w < 1e-3 * reach_w || radius > many * nearest_w;
    if (is_everywhere) depth = nearest_w * slack <= clip.z ? 1.0 : depth;
    if (clip.w + reach_w <= 0.0) half_size = vec2(-1e30);
#ifdef LONG_LENS
    set_meeting(from_eye, radius, is_everywhere ? vec2(0.0) : middle);
#endif
#endif
    half_size += 2.0 * padding_px / picture_px;
#ifdef TRIANGLES
    const vec2 corners[6] = vec2[](vec2(-1, -1), vec2(1, -1), vec2(-1, 1), vec2(-1, 1), vec2(1, -1), vec2(1, 1));
    vec2 corner = corners[gl_VertexID % 6];
    if (half_size.x < 0.0) gl_Position = vec4(0.0, 0.0, -1.0, 1.0);  // behind the eye
    else gl_Position = vec4(is_everywhere ? corner : middle + corner * half_size, depth, 1.0);
#else
    gl_Position = vec4(middle, depth, 1.0);
    gl_PointSize = max(half_size.x * picture_px.x, half_size.y * picture_px.y);
#endif
}
