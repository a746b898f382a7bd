#version 450 core
// The share of a real thing's light that virtual objects leave it. Links with surface/surface.vert.
#include "common/material.glsl"

in vec2 material_uv;
in vec4 vertex_color;
in vec3 vertex_visibility;

layout(location = 0) out vec4 left_of_light;  // premultiplied with the coverage

void main() {
    if (base_color_at(material_uv, vertex_color).a < alpha_cutoff) discard;
    left_of_light = vec4(vertex_visibility, 1.0);
}
