#version 450 core
// Depth of what is behind the nearest surface. Links with surface/surface.vert.
#include "common/material.glsl"
#include "surface/seen.glsl"


uniform sampler2D nearest_depth_share;  // near_m / z of the nearest surface, 0 where nothing is

void main() {
    if (!see()) discard;
#ifndef SPHERES  // spheres/visible.frag saw to it
    // The nearest surface itself, drawn again, may differ by rounding.
    const float same = 1.0 - 1e-5;
    if (gl_FragCoord.z >= same * texelFetch(nearest_depth_share, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
    if (base_color_at(material_uv, vertex_color).a < alpha_cutoff) discard;
}
