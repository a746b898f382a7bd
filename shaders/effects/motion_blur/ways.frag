#version 450 core
// How the nearest surface moves over the picture while the shutter is open. Links with effects/motion_blur/ways.vert.
#include "common/material.glsl"

#ifdef SPHERES
#include "spheres/seen.glsl"
uniform mat4 opening_camera_from_model, closing_camera_from_model;
#else
in vec3 opening_m, closing_m;
in vec2 material_uv;
in vec4 vertex_color;
#endif

uniform uint object_id;
uniform float near_m;

layout(location = 0) out vec4 way;  // xy: change of x/z and y/z; z: object id; w: 1/z at mid-exposure

void main() {
#ifdef SPHERES
    if (!see()) discard;
    vec3 opening_m = (opening_camera_from_model * vec4(model_position, 1.0)).xyz;
    vec3 closing_m = (closing_camera_from_model * vec4(model_position, 1.0)).xyz;
    float inverse_z_m = inverse_z();
#else
    float inverse_z_m = gl_FragCoord.w;  // clip-space w is the camera's z
#endif
    float alpha = base_color_at(material_uv, vertex_color).a;
    // A pixel belongs to a blended surface when that covers at least half of it.
    if (alpha < (alpha_blends ? 0.5 : alpha_cutoff)) discard;
    vec2 change = closing_m.xy / max(closing_m.z, near_m) - opening_m.xy / max(opening_m.z, near_m);
    way = vec4(change, float(object_id), inverse_z_m);
}
