#version 450 core
// A real thing before what is virtual: it covers, and shows nothing of itself. Links with surface/surface.vert.
#include "common/material.glsl"

in vec2 material_uv;
in vec4 vertex_color;

layout(location = 0) out vec4 color;
#ifdef LENS
layout(location = 1) out vec4 focus_share;  // r: near_m / z
#endif
#ifdef COVERAGE
layout(location = COVERAGE) out vec4 coverage;
#endif

void main() {
    if (base_color_at(material_uv, vertex_color).a < alpha_cutoff) discard;
    const vec4 covered = vec4(0.0, 0.0, 0.0, 1.0);
    color = covered;
#ifdef LENS
    focus_share = vec4(gl_FragCoord.z, 0.0, 0.0, 1.0);
#endif
#ifdef COVERAGE
    coverage = covered;
#endif
}
