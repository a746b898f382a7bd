#version 450 core
// What is nearest in each pixel: depth, normal and object. Links with surface/surface.vert.
#include "common/material.glsl"

in vec3 world_position;
in vec3 world_normal;
in vec4 world_tangent;
in vec2 material_uv;
in vec4 vertex_color;

uniform uint object_id;

layout(location = 0) out float depth_m;  // along the camera's z
layout(location = 1) out vec4 normal;    // world, unit length; w = 1
layout(location = 2) out uint id;

void main() {
    float alpha = base_color_at(material_uv, vertex_color).a;
    // A pixel belongs to a blended surface when that covers at least half of it.
    if (alpha < (alpha_blends ? 0.5 : alpha_cutoff)) discard;
    depth_m = 1.0 / gl_FragCoord.w;  // clip-space w is the camera's z
    normal = vec4(shading_normal(world_normal, world_tangent, material_uv, gl_FrontFacing), 1.0);
    id = object_id;
}
