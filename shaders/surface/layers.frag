#version 450 core
// What is nearest in each pixel: depth, normal and object. Links with surface/surface.vert.
#include "common/material.glsl"
#include "surface/seen.glsl"


uniform uint object_id;

layout(location = 0) out float depth_m;  // along the camera's z
layout(location = 1) out vec4 normal;    // world, unit length; w = 1
layout(location = 2) out uint id;

void main() {
    if (!see()) discard;
    float alpha = base_color_at(material_uv, vertex_color).a;
    // A pixel belongs to a blended surface when that covers at least half of it.
    if (alpha < (alpha_blends ? 0.5 : alpha_cutoff)) discard;
    depth_m = 1.0 / inverse_z();
    float slope_variance;
    normal = vec4(shading_normal(world_normal, world_tangent, material_uv, front_facing, slope_variance), 1.0);
    id = object_id;
}
