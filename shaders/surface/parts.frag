#version 450 core
// Which part of which object each sample sees. Links with surface/surface.vert; drawn multisampled.
#include "common/material.glsl"
#include "surface/seen.glsl"


uniform float first_part, material_index;  // the object's first part has this number; of the mesh
uniform int sample_count;

layout(location = 0) out float seen;

// Evenly spaced over every 4 × 4 pixels (Bayer 1973, "An Optimum Method for Two-Level Rendition of Continuous-Tone
// Pictures"), in 0..15.
int rank_in_tile(ivec2 pixel) {
    int diagonal = pixel.x ^ pixel.y;
    return ((diagonal & 1) << 3) | ((pixel.y & 1) << 2) | (diagonal & 2) | ((pixel.y & 2) >> 1);
}

// Samples that a surface of this opacity covers, chosen so that as many of them as there is opacity are, in every pixel
// and in every few (Enderton et al. 2010, "Stochastic Transparency", with even thresholds in place of random ones).
// Parts of other numbers choose others, so that one before the other lets through what it should.
int covered_samples(float part, float opacity) {
    const float golden_section = 0.618034;
    int covered = 0;
    for (int i = 0; i < sample_count; ++i) {
        float even = (float(i) + (float(rank_in_tile(ivec2(gl_FragCoord.xy))) + 0.5) / 16.0) / float(sample_count);
        if (fract(even + golden_section * part) < opacity) covered |= 1 << i;
    }
    return covered;
}

void main() {
    if (!see()) discard;
    float opacity = base_color_at(material_uv, vertex_color).a;
    if (opacity < alpha_cutoff) discard;
    seen = first_part + material_index;
    gl_SampleMask[0] = alpha_blends ? covered_samples(seen, opacity) : ~0;
}
